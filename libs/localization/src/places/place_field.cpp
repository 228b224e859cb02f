#include "topogeo/localization/places/place_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/localization/matching/identical.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::localization {

using geometry::Pose2;

namespace {

// These depend on each other and on the time that a search may take (benchmark relocalize/csail),
// so none is a setting.
constexpr double kSeedCell_m = 0.25;   // a scan may be off by half of it and still score
constexpr double kSeedWidth_m = 0.60;  // of the kernel: spans the 5 degrees between headings
constexpr double kFineCell_m = 0.05;   // as the cells of the global map
constexpr double kFineWidth_m = PlaceField::kFineWidth_m;
constexpr double kFineMargin_m = 1.0;
constexpr std::uint32_t kQuarter = PlaceField::kHeadings / 4;
constexpr std::size_t kPiecePoints = 2048;  // as many as a local map has on the wire
// Of each task. The last ones are small, so that workers end together.
constexpr std::array<std::uint32_t, 14> kTaskHeadings{6, 6, 6, 6, 6, 6, 6, 6, 6, 6, 3, 3, 3, 3};

constexpr bool tasks_stay_in_quarters() {
  std::uint32_t first = 0;
  for (const std::uint32_t headings : kTaskHeadings) {
    if (headings > kQuarter - first % kQuarter) return false;
    first += headings;
  }
  return first == PlaceField::kHeadings;
}
static_assert(tasks_stay_in_quarters());

std::vector<Eigen::Vector2d> in_metres(const std::vector<topomap::ScanPoint>& points) {
  std::vector<Eigen::Vector2d> out;
  out.reserve(points.size());
  for (const topomap::ScanPoint& p : points) out.emplace_back(p.x_m, p.y_m);
  return out;
}

double heading_rad(std::uint32_t heading) {
  return 2.0 * std::numbers::pi / PlaceField::kHeadings * heading;
}

bool comes_before(const PlaceSeed& a, const PlaceSeed& b) {
  return std::tie(b.score, a.cell, a.heading) < std::tie(a.score, b.cell, b.heading);
}

void keep_best(std::vector<PlaceSeed>& seeds, std::size_t count) {
  const auto end = seeds.begin() + std::ssize(seeds);
  const auto kept = seeds.begin() + static_cast<std::ptrdiff_t>(std::min(count, seeds.size()));
  std::partial_sort(seeds.begin(), kept, end, comes_before);
  seeds.erase(kept, end);
}

std::vector<topomap::ScanPoint> points_of_pieces(
    std::span<const std::shared_ptr<const topomap::LocalMap>> pieces) {
  std::vector<topomap::ScanPoint> points;
  for (const auto& piece : pieces) {
    points.insert(points.end(), piece->points.begin(), piece->points.end());
  }
  return points;
}

/// Of pieces that came from elsewhere.
std::vector<topomap::ScanPoint> walls_of(
    std::span<const std::shared_ptr<const topomap::LocalMap>> pieces,
    const PlaceQuestion& question) {
  constexpr float kFarthest_m = 1e5F;  // a grid over more has no whole numbers for its cells
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
    throw std::invalid_argument("place field: its pieces have no wall or half a run of cells");
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
    throw std::invalid_argument("place field: its pieces are those of another one");
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

// First the walls, then the centres of the first and the last cell of each run.
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

PlaceQuestion PlaceField::question_about(std::span<const Eigen::Vector2d> points_m) const {
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
  return all;
}

std::vector<std::shared_ptr<const PlaceQuestion>> PlaceField::questions(
    std::span<const Eigen::Vector2d> points_m) const {
  if (points_m.empty()) return {};
  PlaceQuestion all = question_about(points_m);
  std::vector<std::shared_ptr<const PlaceQuestion>> out;
  for (const std::uint32_t headings : kTaskHeadings) {
    all.headings = headings;
    out.push_back(std::make_shared<const PlaceQuestion>(all));
    all.first_heading += headings;
  }
  return out;
}

std::shared_ptr<const PlaceQuestion> PlaceField::climbing_question(
    std::span<const Eigen::Vector2d> points_m) const {
  return std::make_shared<const PlaceQuestion>(question_about(points_m));
}

void PlaceField::check_points(const PlaceQuestion& question, std::size_t most) const {
  if (question.field_hash != hash_) {
    throw std::invalid_argument("place question: it is about another field");
  }
  if (question.points.empty() || question.points.size() > most) {
    throw std::invalid_argument("place question: " + std::to_string(question.points.size()) +
                                " points, expected 1 to " + std::to_string(most));
  }
}

void PlaceField::check(const PlaceQuestion& question) const {
  check_points(question, kSearchedPoints);
  if (question.headings == 0 || question.first_heading >= kHeadings ||
      question.headings > kQuarter - question.first_heading % kQuarter) {
    throw std::invalid_argument(
        "place question: headings " + std::to_string(question.first_heading) + " and " +
        std::to_string(question.headings) + " from there, expected some of one quarter of " +
        std::to_string(kHeadings));
  }
}

const PlaceField::Run& PlaceField::run_of(std::uint32_t cell) const {
  return *(
      std::upper_bound(runs_.begin(), runs_.end(), std::size_t{cell},
                       [](std::size_t wanted, const Run& run) { return wanted < run.first_seed; }) -
      1);
}

Pose2 PlaceField::pose_of(const PlaceSeed& seed) const {
  const Run& run = run_of(seed.cell);
  const Eigen::Vector2d p =
      grid_.centre_m(run.first_column + static_cast<int>(seed.cell - run.first_seed), run.row);
  return {p.x(), p.y(), geometry::wrap_angle(heading_rad(seed.heading))};
}

std::vector<PlaceField::Offset> PlaceField::offsets(const PlaceQuestion& question,
                                                    std::uint32_t heading) const {
  const geometry::SinCos r = geometry::sincos(heading_rad(heading));
  std::vector<Offset> out;
  out.reserve(question.points.size());
  for (const topomap::ScanPoint& p : question.points) {
    const double x = p.x_m;
    const double y = p.y_m;
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

std::vector<PlaceSeed> PlaceField::answer(const PlaceQuestion& question) const {
  check(question);
  std::vector<PlaceSeed> seeds(cells_);
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
      PlaceSeed* const best = seeds.data() + run.first_seed;
      for (std::size_t k = 0; k < cells; ++k) {
        if (sums[k] <= best[k].score) continue;
        best[k] = {sums[k], static_cast<std::uint16_t>(heading),
                   static_cast<std::uint32_t>(run.first_seed + k)};
      }
    }
  }
  std::erase_if(seeds, [](const PlaceSeed& seed) { return seed.score == 0; });
  keep_best(seeds, kSeeds);
  return seeds;
}

std::string PlaceField::verify(const PlaceQuestion& question,
                               std::span<const PlaceSeed> seeds) const {
  check(question);
  if (seeds.size() > kSeeds) {
    return std::to_string(seeds.size()) + " seeds, at most " + std::to_string(kSeeds) +
           " are asked for";
  }
  std::vector<std::vector<Offset>> moved;
  for (std::uint32_t i = 0; i < question.headings; ++i) {
    moved.push_back(offsets(question, question.first_heading + i));
  }
  std::vector<std::uint32_t> cells;
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    const PlaceSeed& seed = seeds[i];
    const auto name = [i] { return "seed " + std::to_string(i + 1); };
    if (seed.heading < question.first_heading ||
        seed.heading >= question.first_heading + question.headings || seed.cell >= cells_) {
      return name() + " is outside of the search";
    }
    if (i > 0 && !comes_before(seeds[i - 1], seed)) return name() + " is not in its order";
    cells.push_back(seed.cell);
    const Run& run = run_of(seed.cell);
    const int column = run.first_column + static_cast<int>(seed.cell - run.first_seed);
    unsigned score = 0;
    for (const Offset& offset : moved[seed.heading - question.first_heading]) {
      if (!inside(run, offset)) continue;
      score += grid_.row_data(run.row + offset.row)[column + offset.column];
    }
    if (score != seed.score) {
      return "the score of " + name() + " is stated as " + std::to_string(seed.score) + " and is " +
             std::to_string(score);
    }
  }
  std::sort(cells.begin(), cells.end());
  if (std::adjacent_find(cells.begin(), cells.end()) != cells.end()) {
    return "two seeds are in one cell";
  }
  return {};
}

std::vector<MatchSolution> PlaceField::climb_from(const PlaceQuestion& question,
                                                  std::span<const Pose2> poses) const {
  check_points(question, kClimbingPoints);
  const std::vector<Eigen::Vector2d> points_m = in_metres(question.points);
  std::vector<MatchSolution> climbed;
  climbed.reserve(poses.size());
  for (const Pose2& pose : poses) {
    const Climbed place = climb(fine_, points_m, pose);
    climbed.push_back({place.T_map_robot, place.value});
  }
  return climbed;
}

std::string PlaceField::verify(const PlaceQuestion& question, std::span<const Pose2> poses,
                               std::span<const MatchSolution> climbed) const {
  check_points(question, kClimbingPoints);
  if (climbed.size() != poses.size()) {
    return std::to_string(climbed.size()) + " of " + std::to_string(poses.size()) +
           " poses climbed";
  }
  constexpr double kClimbed_m = 2.0;  // more than the steps of a climb together
  const std::vector<Eigen::Vector2d> points_m = in_metres(question.points);
  for (std::size_t i = 0; i < climbed.size(); ++i) {
    const Pose2& T = climbed[i].T_reference_query;
    const std::string name = "pose " + std::to_string(i + 1);
    if (!((T.position_m() - poses[i].position_m()).norm() <= kClimbed_m) ||
        !(std::fabs(T.theta_rad) <= std::numbers::pi)) {
      return name + " is not near where it began";
    }
    const double value = mean_kernel(fine_, points_m, T);
    if (!identical(value, climbed[i].fitness)) {
      return "the value of " + name + " is stated as " + std::to_string(climbed[i].fitness) +
             " and is " + std::to_string(value);
    }
  }
  return {};
}

std::vector<PlaceSeed> best_of(std::span<const std::vector<PlaceSeed>> answers) {
  std::vector<PlaceSeed> seeds;
  for (const std::vector<PlaceSeed>& answer : answers) {
    seeds.insert(seeds.end(), answer.begin(), answer.end());
  }
  std::sort(seeds.begin(), seeds.end(), comes_before);
  std::vector<PlaceSeed> best;
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;  // cell and quarter
  for (const PlaceSeed& seed : seeds) {
    if (best.size() == PlaceField::kSeeds) break;
    if (known.emplace(seed.cell, seed.heading / kQuarter).second) best.push_back(seed);
  }
  return best;
}

}  // namespace topogeo::localization
