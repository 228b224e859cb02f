#include "topogeo/matching/place_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// These depend on each other and on the time limit of a search (benchmark relocalize/csail), so
// none is a setting.
constexpr double kSeedCell_m = 0.25;   // a scan may be off by half a cell and still score
constexpr double kSeedWidth_m = 0.60;  // of the kernel: spans the 5 degrees between headings
constexpr double kFineCell_m = 0.05;   // like the cells of the global map
constexpr double kFineWidth_m = PlaceField::kFineWidth_m;
constexpr double kFineMargin_m = 1.0;
constexpr std::size_t kPiecePoints = 2048;  // limit of a local map on the wire
// Headings per task. The last ones are small, so that workers finish together.
constexpr std::array<std::uint32_t, 12> kTaskHeadings{9, 9, 9, 9, 9, 9, 6, 4, 3, 2, 2, 1};
constexpr std::uint32_t kMostHeadings = 9;
static_assert(std::accumulate(kTaskHeadings.begin(), kTaskHeadings.end(), 0U) ==
              PlaceField::kHeadings);
// Limits of the total movement in a climb.
constexpr double kClimbed_m = 2.0;
constexpr double kClimbed_rad = 0.6;

std::vector<Eigen::Vector2d> in_metres(const std::vector<topomap::ScanPoint>& points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const topomap::ScanPoint& p : points) out.emplace_back(p.x_m, p.y_m);
  return out;
}

double heading_rad(std::uint32_t heading) {
  return 2.0 * std::numbers::pi / PlaceField::kHeadings * heading;
}

std::vector<topomap::ScanPoint> points_of_pieces(
    std::span<const std::shared_ptr<const topomap::LocalMap>> pieces) {
  std::vector<topomap::ScanPoint> points;
  for (const auto& piece : pieces) {
    points.insert(points.end(), piece->points.begin(), piece->points.end());
  }
  return points;
}

/// Walls from received pieces, which are not trusted.
std::vector<topomap::ScanPoint> walls_of(
    std::span<const std::shared_ptr<const topomap::LocalMap>> pieces,
    const PlaceQuestion& question) {
  constexpr float kFarthest_m = 1e5F;  // cells of a larger grid have no integer index
  std::vector<topomap::ScanPoint> walls =
      points_of_pieces(pieces.first(std::min<std::size_t>(question.wall_pieces, pieces.size())));
  const bool near = std::ranges::all_of(walls, [](const topomap::ScanPoint& p) {
    return std::fabs(p.x_m) <= kFarthest_m && std::fabs(p.y_m) <= kFarthest_m;
  });
  if (!near || !(question.margin_m >= 0.0) || question.margin_m > kFarthest_m) {
    throw std::invalid_argument("place field: its pieces reach farther than 100 km");
  }
  return walls;
}

}  // namespace

PlaceField::PlaceField(std::vector<topomap::ScanPoint> walls, double margin_m)
    : walls_(std::move(walls)),
      margin_m_(margin_m),
      grid_(in_metres(walls_), kSeedCell_m, kSeedWidth_m, margin_m),
      fine_(in_metres(walls_), kFineCell_m, kFineWidth_m, kFineMargin_m) {}

PlaceField::PlaceField(std::span<const std::shared_ptr<const topomap::LocalMap>> pieces,
                       const PlaceQuestion& question)
    : PlaceField(walls_of(pieces, question), question.margin_m) {
  const std::vector<topomap::ScanPoint> ends =
      points_of_pieces(pieces.subspan(std::min<std::size_t>(question.wall_pieces, pieces.size())));
  if (walls_.empty() || ends.size() % 2 != 0) {
    throw std::invalid_argument(
        "place field: its pieces have no wall or an incomplete run of cells");
  }
  for (std::size_t i = 0; i < ends.size(); i += 2) {
    const int first = grid_.column(ends[i].x_m);
    const int cells = grid_.column(ends[i + 1].x_m) - first + 1;
    const int row = grid_.row(ends[i].y_m);
    if (row < 0 || row >= grid_.rows() || first < 0 || cells < 1 ||
        first + cells > grid_.columns()) {
      throw std::invalid_argument("place field: a run of cells is not in its grid");
    }
    add_run(row, first, cells);
  }
  make_pieces();
  if (hash_ != question.field_hash) {
    throw std::invalid_argument("place field: its pieces belong to another field");
  }
  pieces_.clear();
}

void PlaceField::set_free(std::span<const std::uint8_t> free) {
  const auto columns = static_cast<std::size_t>(grid_.columns());
  for (int y = 0; y < grid_.rows(); ++y) {
    const std::uint8_t* const row = free.data() + static_cast<std::size_t>(y) * columns;
    for (int x = 0; x < grid_.columns(); ++x) {
      if (row[x] == 0) continue;
      int end = x;
      while (end < grid_.columns() && row[end] != 0) ++end;
      add_run(y, x, end - x);
      x = end;
    }
  }
  make_pieces();
}

void PlaceField::add_run(int row, int first_column, int cells) {
  runs_.push_back({row, first_column, cells, cells_});
  cells_ += static_cast<std::size_t>(cells);
}

// Pieces of the walls first, then of the centres of the first and the last cell of each run.
void PlaceField::make_pieces() {
  support::Fnv1a hash;
  hash.add(static_cast<std::uint64_t>(std::llround(margin_m_ * 1e6)));
  const auto cut = [&](const std::vector<topomap::ScanPoint>& points) {
    for (std::size_t first = 0; first < points.size(); first += kPiecePoints) {
      const std::size_t last = std::min(first + kPiecePoints, points.size());
      auto piece = std::make_shared<topomap::LocalMap>();
      piece->id = kFirstPiece + static_cast<std::uint32_t>(pieces_.size());
      piece->points.assign(points.begin() + static_cast<std::ptrdiff_t>(first),
                           points.begin() + static_cast<std::ptrdiff_t>(last));
      piece_hashes_.push_back(topomap::content_hash(*piece));
      hash.add(piece_hashes_.back());
      pieces_.push_back(std::move(piece));
    }
    hash.add(pieces_.size());
  };
  std::vector<topomap::ScanPoint> ends;
  for (const Run& run : runs_) {
    for (const int column : {run.first_column, run.first_column + run.cells - 1}) {
      const Eigen::Vector2d p = grid_.centre_m(column, run.row);
      ends.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
    }
  }
  cut(walls_);
  cut(ends);
  hash_ = hash.value();
}

std::size_t PlaceField::bytes() const {
  const auto cells = [](const KernelGrid& grid) {
    return static_cast<std::size_t>(grid.columns()) * static_cast<std::size_t>(grid.rows());
  };
  return cells(grid_) + cells(fine_) + walls_.size() * sizeof(topomap::ScanPoint) +
         runs_.size() * sizeof(Run);
}

std::vector<std::shared_ptr<const PlaceQuestion>> PlaceField::questions(
    std::span<const Eigen::Vector2d> points_m) const {
  if (points_m.empty()) return {};
  PlaceQuestion all;
  all.field_hash = hash_;
  all.margin_m = margin_m_;
  all.wall_pieces = static_cast<std::uint32_t>((walls_.size() + kPiecePoints - 1) / kPiecePoints);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    all.pieces.push_back({pieces_[i]->id, piece_hashes_[i]});
  }
  for (const Eigen::Vector2d& p : points_m) {
    all.points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
  }
  std::vector<std::shared_ptr<const PlaceQuestion>> out;
  for (const std::uint32_t headings : kTaskHeadings) {
    all.headings = headings;
    out.push_back(std::make_shared<const PlaceQuestion>(all));
    all.first_heading += headings;
  }
  return out;
}

void PlaceField::check(const PlaceQuestion& question) const {
  if (question.field_hash != hash_) {
    throw std::invalid_argument("place question: it is about another field");
  }
  if (question.points.empty() || question.points.size() > kPoints) {
    throw std::invalid_argument("place question: " + std::to_string(question.points.size()) +
                                " points, expected 1 to " + std::to_string(kPoints));
  }
  if (question.headings == 0 || question.headings > kMostHeadings ||
      question.first_heading >= kHeadings ||
      question.headings > kHeadings - question.first_heading) {
    throw std::invalid_argument(
        "place question: headings " + std::to_string(question.first_heading) + " and " +
        std::to_string(question.headings) + " from there, expected at most " +
        std::to_string(kMostHeadings) + " of " + std::to_string(kHeadings));
  }
}

const PlaceField::Run& PlaceField::run_of(std::uint32_t cell) const {
  return *(
      std::upper_bound(runs_.begin(), runs_.end(), std::size_t{cell},
                       [](std::size_t wanted, const Run& run) { return wanted < run.first_seed; }) -
      1);
}

Pose2 PlaceField::pose_of(const Seed& seed) const {
  const Run& run = run_of(seed.cell);
  const Eigen::Vector2d p =
      grid_.centre_m(run.first_column + static_cast<int>(seed.cell - run.first_seed), run.row);
  return {p.x(), p.y(), geometry::wrap_angle(heading_rad(seed.heading))};
}

std::vector<PlaceField::Offset> PlaceField::offsets(const PlaceQuestion& question,
                                                    std::uint32_t heading) const {
  const geometry::SinCos r = geometry::sincos(heading_rad(heading));
  const std::size_t step = question.points.size() > kPoints / 2 ? 2 : 1;
  std::vector<Offset> out;
  out.reserve(question.points.size());
  for (std::size_t i = 0; i < question.points.size(); i += step) {
    const double x = question.points[i].x_m;
    const double y = question.points[i].y_m;
    out.push_back({static_cast<int>(std::floor((r.cos * x - r.sin * y) / grid_.cell_m() + 0.5)),
                   static_cast<int>(std::floor((r.sin * x + r.cos * y) / grid_.cell_m() + 0.5))});
  }
  return out;
}

bool PlaceField::inside(const Run& run, const Offset& offset) const {
  const int row = run.row + offset.row;
  const int column = run.first_column + offset.column;
  return row >= 0 && row < grid_.rows() && column >= 0 && column + run.cells <= grid_.columns();
}

std::vector<PlaceField::Seed> PlaceField::scored(const PlaceQuestion& question) const {
  std::vector<Seed> seeds(cells_);
  std::vector<std::uint16_t> sums;
  for (std::uint32_t i = 0; i < question.headings; ++i) {
    const std::uint32_t heading = question.first_heading + i;
    const std::vector<Offset> moved = offsets(question, heading);
    for (const Run& run : runs_) {
      const auto cells = static_cast<std::size_t>(run.cells);
      sums.assign(cells, 0);
      for (const Offset& offset : moved) {
        if (!inside(run, offset)) continue;
        const std::uint8_t* from =
            grid_.row_data(run.row + offset.row) + run.first_column + offset.column;
        std::uint16_t* to = sums.data();
        for (std::size_t k = 0; k < cells; ++k) to[k] = static_cast<std::uint16_t>(to[k] + from[k]);
      }
      Seed* const best = seeds.data() + run.first_seed;
      for (std::size_t k = 0; k < cells; ++k) {
        if (sums[k] <= best[k].score) continue;
        best[k] = {sums[k], static_cast<std::uint16_t>(heading),
                   static_cast<std::uint32_t>(run.first_seed + k)};
      }
    }
  }
  std::erase_if(seeds, [](const Seed& seed) { return seed.score == 0; });
  return seeds;
}

bool PlaceField::comes_before(const Seed& a, const Seed& b) {
  return std::tie(b.score, a.cell, a.heading) < std::tie(a.score, b.cell, b.heading);
}

std::vector<Pose2> PlaceField::starts(const PlaceQuestion& question) const {
  const std::size_t wanted = kTaskPoses * question.headings / kMostHeadings;
  // Each start excludes its up to eight neighbours.
  constexpr std::size_t kTouching = 9;
  std::vector<Seed> seeds = scored(question);
  const auto best =
      seeds.begin() + static_cast<std::ptrdiff_t>(std::min(kTouching * wanted, seeds.size()));
  std::partial_sort(seeds.begin(), best, seeds.end(), comes_before);
  seeds.erase(best, seeds.end());
  std::set<std::pair<int, int>> excluded;  // row and column
  std::vector<Pose2> poses;
  for (const Seed& seed : seeds) {
    if (poses.size() == wanted) break;
    const Run& run = run_of(seed.cell);
    const int column = run.first_column + static_cast<int>(seed.cell - run.first_seed);
    if (excluded.contains({run.row, column})) continue;
    for (int y = -1; y <= 1; ++y) {
      for (int x = -1; x <= 1; ++x) excluded.emplace(run.row + y, column + x);
    }
    poses.push_back(pose_of(seed));
  }
  return poses;
}

std::vector<MatchSolution> PlaceField::answer(const PlaceQuestion& question) const {
  check(question);
  const std::vector<Eigen::Vector2d> points_m = in_metres(question.points);
  std::vector<MatchSolution> places;
  for (const Pose2& start : starts(question)) {
    const Climbed place = climb(fine_, points_m, start);
    places.push_back({place.T_map_robot, place.value});
  }
  return places;
}

bool PlaceField::near_free_cell(const Eigen::Vector2d& p_m) const {
  const int reach = static_cast<int>(kClimbed_m / kSeedCell_m) + 1;
  const int row = grid_.row(p_m.y());
  const int column = grid_.column(p_m.x());
  const auto first = std::ranges::lower_bound(runs_, row - reach, std::ranges::less{}, &Run::row);
  const auto last = std::ranges::upper_bound(runs_, row + reach, std::ranges::less{}, &Run::row);
  return std::any_of(first, last, [&](const Run& run) {
    return column >= run.first_column - reach && column < run.first_column + run.cells + reach;
  });
}

std::string PlaceField::verify(const PlaceQuestion& question,
                               std::span<const MatchSolution> places) const {
  check(question);
  if (places.size() > kTaskPoses) {
    return std::to_string(places.size()) + " places, expected at most " +
           std::to_string(kTaskPoses);
  }
  const std::vector<Eigen::Vector2d> points_m = in_metres(question.points);
  const double middle_rad =
      heading_rad(question.first_heading) + 0.5 * heading_rad(question.headings - 1);
  const double most_rad = 0.5 * heading_rad(question.headings - 1) + kClimbed_rad;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Pose2& T = places[i].T_reference_query;
    const std::string name = "place " + std::to_string(i + 1);
    if (!(std::fabs(T.theta_rad) <= std::numbers::pi) ||
        !(std::fabs(geometry::wrap_angle(T.theta_rad - middle_rad)) <= most_rad) ||
        !near_free_cell(T.position_m())) {
      return name + " is outside of the search";
    }
    const double value = mean_kernel(fine_, points_m, T);
    if (!identical(value, places[i].fitness)) {
      return "the value of " + name + " is " + std::to_string(places[i].fitness) + ", expected " +
             std::to_string(value);
    }
  }
  return {};
}

}  // namespace topogeo::localization
