#include "path_band.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kStep_m = 0.08;  // between the points of a band: half of the robot's swing-out

std::vector<Eigen::Vector2d> dense(std::span<const Eigen::Vector2d> points_m) {
  std::vector<Eigen::Vector2d> result;
  for (std::size_t i = 0; i + 1 < points_m.size(); ++i) {
    const Eigen::Vector2d vector_m = points_m[i + 1] - points_m[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(vector_m.norm() / kStep_m)));
    for (int k = 0; k < steps; ++k) {
      result.emplace_back(points_m[i] + static_cast<double>(k) / steps * vector_m);
    }
  }
  if (!points_m.empty()) result.push_back(points_m.back());
  return result;
}

// The same line with its points at equal distances.
std::vector<Eigen::Vector2d> evenly(const std::vector<Eigen::Vector2d>& points_m) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    length_m += (points_m[i] - points_m[i - 1]).norm();
  }
  const int pieces = std::max(1, static_cast<int>(std::lround(length_m / kStep_m)));
  std::vector<Eigen::Vector2d> result{points_m.front()};
  double passed_m = 0.0;
  std::size_t at = 1;
  for (int k = 1; k < pieces; ++k) {
    const double wanted_m = length_m * k / pieces;
    double piece_m = (points_m[at] - points_m[at - 1]).norm();
    while (passed_m + piece_m < wanted_m && at + 1 < points_m.size()) {
      passed_m += piece_m;
      ++at;
      piece_m = (points_m[at] - points_m[at - 1]).norm();
    }
    const double share = piece_m > 0.0 ? (wanted_m - passed_m) / piece_m : 0.0;
    result.emplace_back(points_m[at - 1] + share * (points_m[at] - points_m[at - 1]));
  }
  if (points_m.size() > 1) result.push_back(points_m.back());
  return result;
}

// Angle between the pieces before and after a point.
double turn_at(const std::vector<Eigen::Vector2d>& points_m, std::size_t i) {
  const Eigen::Vector2d in = points_m[i] - points_m[i - 1];
  const Eigen::Vector2d out = points_m[i + 1] - points_m[i];
  return geometry::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
}

class Field {
 public:
  Field(const planning::FreeSpace& space, std::span<const Eigen::Vector2d> obstacles_m)
      : space_(space), obstacles_m_(obstacles_m) {}

  // Approximate distance to the nearest surface of the map or obstacle; linear between the middles
  // of cells.
  [[nodiscard]] double clearance_m(const Eigen::Vector2d& point_m) const {
    const planning::GridFrame& frame = space_.frame();
    const Eigen::Vector2d at = frame.in_cells(point_m) - Eigen::Vector2d(0.5, 0.5);
    const double column = std::floor(at.x());
    const double row = std::floor(at.y());
    const double x = at.x() - column;
    const double y = at.y() - row;
    const planning::Cell cell{static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)};
    const double lower = (1.0 - x) * of(cell, 0, 0) + x * of(cell, 1, 0);
    const double upper = (1.0 - x) * of(cell, 0, 1) + x * of(cell, 1, 1);
    double least_m = (1.0 - y) * lower + y * upper - 0.5 * frame.resolution_m;
    for (const Eigen::Vector2d& obstacle_m : obstacles_m_) {
      least_m = std::min(least_m, (obstacle_m - point_m).norm());
    }
    return least_m;
  }

  [[nodiscard]] Eigen::Vector2d uphill(const Eigen::Vector2d& point_m) const {
    constexpr double kSlopeReach_m = 0.05;
    const Eigen::Vector2d x(kSlopeReach_m, 0.0);
    const Eigen::Vector2d y(0.0, kSlopeReach_m);
    const Eigen::Vector2d slope(clearance_m(point_m + x) - clearance_m(point_m - x),
                                clearance_m(point_m + y) - clearance_m(point_m - y));
    return slope / (2.0 * kSlopeReach_m);
  }

 private:
  [[nodiscard]] double of(const planning::Cell& cell, std::int32_t x, std::int32_t y) const {
    const planning::Cell there{cell.column + x, cell.row + y};
    constexpr double kMost_m = 2.0;  // more room does not improve a path
    if (!space_.frame().contains(there)) return 0.0;
    if (space_.grid().at(there) != planning::CellState::kFree) return 0.0;
    return std::min(kMost_m, space_.clearance_m(there));
  }

  const planning::FreeSpace& space_;
  std::span<const Eigen::Vector2d> obstacles_m_;
};

// Widens bends that are too tight, as far as there is room.
void relax(std::vector<Eigen::Vector2d>& path_m, const Field& field, double least_m) {
  constexpr int kRounds = 40;
  constexpr double kTightest_rad = 3.0 * kStep_m;  // a circle of a third of a metre
  for (int round = 0; round < kRounds; ++round) {
    bool any = false;
    for (std::size_t i = 1; i + 1 < path_m.size(); ++i) {
      if (std::fabs(turn_at(path_m, i)) < kTightest_rad) continue;
      const Eigen::Vector2d moved_m = 0.5 * path_m[i] + 0.25 * (path_m[i - 1] + path_m[i + 1]);
      const double room_m = field.clearance_m(moved_m);
      if (room_m < least_m && room_m < field.clearance_m(path_m[i])) continue;
      path_m[i] = moved_m;
      any = true;
    }
    if (!any) return;
  }
}

}  // namespace

bool stays_in(const planning::FreeSpace& space, const std::vector<Eigen::Vector2d>& path_m) {
  constexpr double kEnds_m = 0.4;
  return std::ranges::all_of(path_m, [&](const Eigen::Vector2d& point_m) {
    const auto cell = space.frame().cell_of(point_m);
    const bool at_end =
        (point_m - path_m.front()).norm() < kEnds_m || (point_m - path_m.back()).norm() < kEnds_m;
    return cell && (at_end || space.passable(*cell));
  });
}

BandConfig band_of(const GuardConfig& guard) {
  constexpr double kWishedBeside_m = 0.3;  // free beside the body, if there is room
  constexpr double kLeastBeside_m = 0.07;  // the same in tight bends
  return {guard.radius_m + kWishedBeside_m, guard.radius_m + kLeastBeside_m};
}

std::vector<Eigen::Vector2d> band(const planning::FreeSpace& space,
                                  std::span<const Eigen::Vector2d> points_m,
                                  std::span<const Eigen::Vector2d> obstacles_m,
                                  const BandConfig& config) {
  constexpr int kRounds = 60;
  constexpr int kSmoothingOnly = 6;  // last rounds: they smooth kinks left by pushes
  constexpr int kEvenlyEvery = 10;   // pushed points drift apart
  constexpr double kPull = 0.3;
  constexpr double kPush = 0.15;
  constexpr double kLargestPush_m = 0.02;
  std::vector<Eigen::Vector2d> path_m = dense(points_m);
  const Field field(space, obstacles_m);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Vector2d> next_m = path_m;
    for (std::size_t i = 1; i + 1 < path_m.size(); ++i) {
      next_m[i] += kPull * (0.5 * (path_m[i - 1] + path_m[i + 1]) - path_m[i]);
      if (round + kSmoothingOnly >= kRounds) continue;
      const double missing_m = config.wished_m - field.clearance_m(path_m[i]);
      if (missing_m <= 0.0) continue;
      next_m[i] += std::min(kPush * missing_m, kLargestPush_m) * field.uphill(path_m[i]);
    }
    // The band is torn where the path leads through an obstacle.
    constexpr double kTorn = 2.5;
    for (std::size_t i = 1; i < next_m.size(); ++i) {
      if ((next_m[i] - next_m[i - 1]).norm() > kTorn * kStep_m) return {};
    }
    path_m = (round + 1) % kEvenlyEvery == 0 ? evenly(next_m) : std::move(next_m);
  }
  relax(path_m, field, config.least_m);
  path_m = evenly(path_m);
  if (!stays_in(space, path_m)) return {};
  return path_m;
}

std::vector<Eigen::Vector2d> rounded(std::span<const Eigen::Vector2d> points_m) {
  constexpr int kRounds = 8;  // corners are cut by about a step of the line
  std::vector<Eigen::Vector2d> path_m = evenly(dense(points_m));
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Eigen::Vector2d> next_m = path_m;
    for (std::size_t i = 1; i + 1 < path_m.size(); ++i) {
      next_m[i] = 0.5 * path_m[i] + 0.25 * (path_m[i - 1] + path_m[i + 1]);
    }
    path_m = std::move(next_m);
  }
  return path_m;
}
std::vector<planning::PathSample> samples_of(std::span<const Eigen::Vector2d> points_m,
                                             double corner_rad) {
  std::vector<Eigen::Vector2d> kept_m;
  constexpr double kSame_m = 0.01;
  for (const Eigen::Vector2d& point_m : points_m) {
    if (kept_m.empty() || (point_m - kept_m.back()).norm() > kSame_m) kept_m.push_back(point_m);
  }
  if (!points_m.empty() && !kept_m.empty()) kept_m.back() = points_m.back();
  if (kept_m.size() < 2) return {};
  std::vector<planning::PathSample> samples;
  double distance_m = 0.0;
  double before_rad = 0.0;
  for (std::size_t i = 0; i + 1 < kept_m.size(); ++i) {
    const Eigen::Vector2d vector_m = kept_m[i + 1] - kept_m[i];
    const double heading_rad = geometry::atan2(vector_m.y(), vector_m.x());
    const double turn_rad = i == 0 ? 0.0 : geometry::wrap_angle(heading_rad - before_rad);
    const bool corner = std::fabs(turn_rad) > corner_rad;
    samples.push_back(
        {{kept_m[i].x(), kept_m[i].y(), heading_rad}, distance_m, 0.0, corner ? turn_rad : 0.0});
    if (!corner && i > 0) {
      const double around_m = 0.5 * (vector_m.norm() + (kept_m[i] - kept_m[i - 1]).norm());
      samples.back().curvature_per_m = turn_rad / around_m;
      // Half of the turn belongs to the part before the corner of the polyline.
      samples.back().T_map_robot.theta_rad = geometry::wrap_angle(heading_rad - 0.5 * turn_rad);
    }
    distance_m += vector_m.norm();
    before_rad = heading_rad;
  }
  samples.push_back({{kept_m.back().x(), kept_m.back().y(), before_rad}, distance_m, 0.0, 0.0});
  return samples;
}

}  // namespace topogeo::navigation
