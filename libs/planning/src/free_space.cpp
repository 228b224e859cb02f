#include "topogeo/planning/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cell_neighbours.hpp"

namespace topogeo::planning {
namespace {

// The lower envelope of parabolas over one line of the grid, in integers: the squared distance is
// value[i] + (x - i)^2, and two parabolas p < q intersect where q becomes the lower one.
class LineTransform {
 public:
  explicit LineTransform(std::size_t length) : value_(length), places_(length), starts_(length) {}

  std::vector<std::int32_t>& values() { return value_; }

  template <typename Store>
  void run(Store&& store) {
    const auto length = static_cast<std::int64_t>(value_.size());
    std::size_t kept = 0;
    for (std::int64_t q = 0; q < length; ++q) {
      if (at(q) == FreeSpace::kNoObstacle) continue;
      std::int64_t from = 0;
      while (kept > 0) {
        from = first_lower(places_[kept - 1], q);
        if (from > starts_[kept - 1]) break;
        --kept;
      }
      if (kept == 0) from = 0;
      if (from >= length) continue;
      places_[kept] = q;
      starts_[kept] = from;
      ++kept;
    }
    std::size_t k = 0;
    for (std::int64_t x = 0; x < length; ++x) {
      while (k + 1 < kept && starts_[k + 1] <= x) ++k;
      store(x, kept == 0 ? FreeSpace::kNoObstacle : distance(places_[k], x));
    }
  }

 private:
  [[nodiscard]] std::int32_t at(std::int64_t i) const {
    return value_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] std::int32_t distance(std::int64_t i, std::int64_t x) const {
    return static_cast<std::int32_t>(at(i) + (x - i) * (x - i));
  }

  // Least x at which the parabola at q > p is below that at p.
  [[nodiscard]] std::int64_t first_lower(std::int64_t p, std::int64_t q) const {
    const std::int64_t above = (at(q) + q * q) - (at(p) + p * p);
    const std::int64_t twice = 2 * (q - p);
    return above < 0 ? 0 : above / twice + 1;
  }

  std::vector<std::int32_t> value_;
  std::vector<std::int64_t> places_;
  std::vector<std::int64_t> starts_;
};

std::vector<std::int32_t> squared_distances(const OccupancyGrid& grid, bool unknown_too) {
  const GridFrame& frame = grid.frame();
  const auto columns = static_cast<std::size_t>(frame.columns);
  const auto rows = static_cast<std::size_t>(frame.rows);
  std::vector<std::int32_t> squared(frame.size());
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const CellState state = grid.cells()[i];
    const bool obstacle =
        state == CellState::kOccupied || (unknown_too && state == CellState::kUnknown);
    squared[i] = obstacle ? 0 : FreeSpace::kNoObstacle;
  }
  LineTransform upright(rows);
  for (std::size_t x = 0; x < columns; ++x) {
    for (std::size_t y = 0; y < rows; ++y) upright.values()[y] = squared[y * columns + x];
    upright.run([&](std::int64_t y, std::int32_t value) {
      squared[static_cast<std::size_t>(y) * columns + x] = value;
    });
  }
  LineTransform across(columns);
  for (std::size_t y = 0; y < rows; ++y) {
    const auto row = squared.begin() + static_cast<std::ptrdiff_t>(y * columns);
    std::copy_n(row, columns, across.values().begin());
    across.run([&](std::int64_t x, std::int32_t value) { row[x] = value; });
  }
  return squared;
}

}  // namespace

FreeSpace::FreeSpace(OccupancyGrid grid, const InflationConfig& config,
                     std::span<const DrawnZone> zones, std::span<const DrawnLine> lines)
    : grid_(std::move(grid)), config_(config), rules_(grid_.frame(), zones, lines) {
  check(config);
  draw_lines();
  squared_ = squared_distances(grid_, config.inflate_unknown);
  passable_.resize(squared_.size());
  const double forbidden = config.forbidden_cells * config.forbidden_cells;
  for (std::size_t i = 0; i < squared_.size(); ++i) {
    passable_[i] = grid_.cells()[i] == CellState::kFree && squared_[i] > forbidden ? 1 : 0;
  }
  keep_out_of_no_go(forbidden);
  close_pockets();
}

void FreeSpace::draw_lines() {
  if (rules_.walls().empty() && rules_.open().empty()) return;
  seen_ = grid_;
  for (const Cell& cell : rules_.walls()) grid_.set(cell, CellState::kOccupied);
  for (const Cell& cell : rules_.open()) grid_.set(cell, CellState::kFree);
}

void FreeSpace::keep_out_of_no_go(double forbidden) {
  if (rules_.no_go().empty()) return;
  OccupancyGrid no_go(frame());
  for (const Cell& cell : rules_.no_go()) no_go.set(cell, CellState::kOccupied);
  const std::vector<std::int32_t> to_zone = squared_distances(no_go, false);
  for (std::size_t i = 0; i < to_zone.size(); ++i) {
    if (to_zone[i] <= forbidden) passable_[i] = 0;
  }
}

void FreeSpace::close_pockets() {
  const double least_cells = config_.min_pocket_m2 / (frame().resolution_m * frame().resolution_m);
  if (least_cells <= 1.0) return;
  std::vector<bool> visited(passable_.size(), false);
  std::vector<std::size_t> piece;
  for (std::size_t first = 0; first < passable_.size(); ++first) {
    if (visited[first] || passable_[first] == 0) continue;
    piece.assign(1, first);
    visited[first] = true;
    for (std::size_t done = 0; done < piece.size(); ++done) {
      visit_neighbours(frame(), piece[done], [&](std::size_t j) {
        if (visited[j] || passable_[j] == 0) return;
        visited[j] = true;
        piece.push_back(j);
      });
    }
    if (static_cast<double>(piece.size()) >= least_cells) continue;
    for (const std::size_t i : piece) passable_[i] = 0;
  }
}

FreeSpace FreeSpace::opened(std::span<const Cell> freed, std::span<const Cell> entered) const {
  OccupancyGrid grid = seen();
  for (const Cell& cell : freed) grid.set(cell, CellState::kFree);
  FreeSpace space(std::move(grid), config_, rules_.zones(), rules_.lines());
  for (const Cell& cell : entered) space.passable_[frame().index(cell)] = 1;
  return space;
}

double FreeSpace::clearance_m(const Cell& cell) const {
  const std::int32_t squared = squared_[frame().index(cell)];
  if (squared == kNoObstacle) return std::numeric_limits<double>::infinity();
  return std::sqrt(static_cast<double>(squared)) * frame().resolution_m;
}

}  // namespace topogeo::planning
