#include "clearance_basins.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "cell_neighbours.hpp"

namespace topogeo::planning {
namespace {

class Flood {
 public:
  explicit Flood(const FreeSpace& walls) : walls_(walls) {
    basins_.of_cell.assign(walls.frame().size(), kNoBasin);
  }

  Basins run() {
    const std::vector<std::vector<std::size_t>> levels = cells_by_level();
    for (auto level = levels.rbegin(); level != levels.rend(); ++level) {
      level_of_ = static_cast<std::size_t>(levels.rend() - level) - 1;
      spread(*level);
      for (const std::size_t first : *level) {
        if (basins_.of_cell[first] == kNoBasin) start_at(first);
      }
    }
    find_saddles();
    return std::move(basins_);
  }

 private:
  [[nodiscard]] double clearance_m(std::size_t i) const {
    return walls_.clearance_m(walls_.frame().cell_at(i));
  }

  [[nodiscard]] std::size_t level(std::size_t i) const {
    constexpr double kStep_m = 0.1;  // smaller differences are noise of the grid
    return static_cast<std::size_t>(clearance_m(i) /
                                    std::max(kStep_m, walls_.frame().resolution_m));
  }

  [[nodiscard]] std::vector<std::vector<std::size_t>> cells_by_level() const {
    std::vector<std::vector<std::size_t>> levels;
    for (std::size_t i = 0; i < basins_.of_cell.size(); ++i) {
      if (walls_.squared_cells(i) == 0 || walls_.squared_cells(i) == FreeSpace::kNoObstacle)
        continue;
      const std::size_t at = level(i);
      if (at >= levels.size()) levels.resize(at + 1);
      levels[at].push_back(i);
    }
    return levels;
  }

  // A basin grows only as far as the slope beside a wall. Cells further off belong to a flat floor
  // of this height, like a corridor between two halls, which is a basin of its own.
  void spread(const std::vector<std::size_t>& cells) {
    constexpr int kSteps = 3;
    for (int step = 0; step < kSteps; ++step) {
      std::vector<std::pair<std::size_t, std::uint32_t>> grown;
      for (const std::size_t i : cells) {
        if (basins_.of_cell[i] != kNoBasin) continue;
        const std::uint32_t basin = widest_beside(i);
        if (basin != kNoBasin) grown.emplace_back(i, basin);
      }
      for (const auto& [i, basin] : grown) basins_.of_cell[i] = basin;
    }
  }

  // The basin of the neighbour with the most clearance.
  [[nodiscard]] std::uint32_t widest_beside(std::size_t i) const {
    std::uint32_t basin = kNoBasin;
    std::int32_t most = -1;
    visit_neighbours(walls_.frame(), i, [&](std::size_t j) {
      if (basins_.of_cell[j] == kNoBasin || walls_.squared_cells(j) <= most) return;
      basin = basins_.of_cell[j];
      most = walls_.squared_cells(j);
    });
    return basin;
  }

  void start_at(std::size_t first) {
    const auto basin = static_cast<std::uint32_t>(basins_.peak_m.size());
    basins_.of_cell[first] = basin;
    double peak_m = 0.0;
    std::vector<std::size_t> open{first};
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      peak_m = std::max(peak_m, clearance_m(i));
      visit_neighbours(walls_.frame(), i, [&](std::size_t j) {
        if (basins_.of_cell[j] != kNoBasin || walls_.squared_cells(j) == 0) return;
        if (level(j) != level_of_) return;
        basins_.of_cell[j] = basin;
        open.push_back(j);
      });
    }
    basins_.peak_m.push_back(peak_m);
  }

  void find_saddles() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, Saddle> found;
    for (std::size_t i = 0; i < basins_.of_cell.size(); ++i) {
      if (basins_.of_cell[i] == kNoBasin) continue;
      visit_neighbours(walls_.frame(), i, [&](std::size_t j) {
        const std::uint32_t a = basins_.of_cell[i];
        const std::uint32_t b = basins_.of_cell[j];
        if (b == kNoBasin || a >= b) return;
        const double between_m = std::min(clearance_m(i), clearance_m(j));
        Saddle& saddle = found.try_emplace({a, b}, Saddle{a, b, -1.0, i}).first->second;
        if (between_m > saddle.clearance_m) saddle = {a, b, between_m, i};
      });
    }
    for (const auto& [pair, saddle] : found) basins_.saddles.push_back(saddle);
  }

  const FreeSpace& walls_;
  Basins basins_;
  std::size_t level_of_ = 0;  // current flood level
};

}  // namespace

Basins clearance_basins(const FreeSpace& walls) {
  return Flood(walls).run();
}

}  // namespace topogeo::planning
