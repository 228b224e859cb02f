#include "local_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "topogeo/geometry/segment.hpp"
#include "topogeo/navigation/path_follower.hpp"
#include "topogeo/planning/outline_planner.hpp"

#include "path_band.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kNear_m = 0.3;    // this near to the goal the path is straight
constexpr double kReach_m = 10.0;  // along a path: the range of a scan

/// Each obstacle, surrounded by four points.
std::vector<Eigen::Vector2d> widened(std::span<const Eigen::Vector2d> obstacles_m, double by_m) {
  std::vector<Eigen::Vector2d> points_m(obstacles_m.begin(), obstacles_m.end());
  for (const Eigen::Vector2d& obstacle_m : obstacles_m) {
    points_m.emplace_back(obstacle_m + Eigen::Vector2d(by_m, 0.0));
    points_m.emplace_back(obstacle_m - Eigen::Vector2d(by_m, 0.0));
    points_m.emplace_back(obstacle_m + Eigen::Vector2d(0.0, by_m));
    points_m.emplace_back(obstacle_m - Eigen::Vector2d(0.0, by_m));
  }
  return points_m;
}

/// The robot, and the rest of a line from `ahead_m` after the place nearest to it; always contains
/// the end.
std::vector<Eigen::Vector2d> rest_of(std::span<const Eigen::Vector2d> points_m,
                                     const Eigen::Vector2d& robot_m, double ahead_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  double passed_m = 0.0;
  double at_m = 0.0;
  for (std::size_t i = 0; i + 1 < points_m.size(); ++i) {
    const Eigen::Vector2d line_m = points_m[i + 1] - points_m[i];
    const auto [place_m, share] =
        geometry::nearest_on_segment(points_m[i], points_m[i + 1], robot_m);
    const double off_m = (place_m - robot_m).norm();
    if (off_m < nearest_m) {
      nearest_m = off_m;
      at_m = passed_m + share * line_m.norm();
    }
    passed_m += line_m.norm();
  }
  std::vector<Eigen::Vector2d> rest_m{robot_m};
  passed_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) {
    passed_m += (points_m[i] - points_m[i - 1]).norm();
    if (passed_m > at_m + ahead_m) rest_m.push_back(points_m[i]);
  }
  if (rest_m.size() == 1) rest_m.push_back(points_m.back());
  return rest_m;
}

}  // namespace

std::vector<planning::PathSample> LocalPlanner::shape(
    const planning::FreeSpace& space, std::span<const Eigen::Vector2d> points_m,
    std::span<const Eigen::Vector2d> obstacles_m) const {
  if (config_.motion == MotionStyle::kPrimitives) return straight_path(points_m);
  constexpr double kCorner_rad = 0.9;  // sharper corners are turned on the spot
  const BandConfig wished = band_of(config_.guard);
  auto banded_m = band(space, points_m, obstacles_m, wished);
  if (banded_m.empty()) banded_m = band(space, points_m, {}, wished);
  if (!banded_m.empty()) return samples_of(banded_m, kCorner_rad);
  return planning::smooth_path(space, points_m, config_.smooth);
}

std::vector<planning::PathSample> LocalPlanner::along_route(const RouteKeeper& route,
                                                            const Eigen::Vector2d& robot_m) const {
  constexpr double kJoin_m = 0.5;  // distance at which it rejoins a route beside it
  const std::vector<Eigen::Vector2d> points_m = rest_of(route.route().points_m, robot_m, kJoin_m);
  if (config_.motion == MotionStyle::kPrimitives) return straight_path(points_m);
  constexpr double kCorner_rad = 0.9;  // as in shape()
  const auto rounded_m = rounded(points_m);
  if (!stays_in(*route.space(), rounded_m)) return {};
  return samples_of(rounded_m, kCorner_rad);
}

LocalPath LocalPlanner::plan(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                             std::span<const Eigen::Vector2d> obstacles_m,
                             const std::optional<SeenScan>& scan) const {
  LocalPath on_grid = plan_on_grid(route, robot_m, obstacles_m);
  if (!on_grid.path.empty() || !scan) return on_grid;
  LocalPath on_branches = plan_on_branches(*scan, route, robot_m, obstacles_m);
  return on_branches.path.empty() ? on_grid : on_branches;
}

LocalPath LocalPlanner::plan_outline(const RouteKeeper& route, const geometry::Pose2& T_map_robot,
                                     std::span<const Eigen::Vector2d> obstacles_m) const {
  planning::OutlineConfig config;
  config.footprint = outline_of(config_.guard);
  config.minimum_radius_m = config_.guard.minimum_turning_radius_m;
  const planning::PoseGoal goal{route.goal_m(), route.route().heading_rad};
  planning::OutlinePath path =
      planning::plan_outline(*route.space(), T_map_robot, goal, obstacles_m, config);
  LocalPath local;
  if (path.found()) {
    local.status = planning::DetourStatus::kClear;
    local.path = std::move(path.samples);
    return local;
  }
  local.status = planning::DetourStatus::kBlocked;
  if (!obstacles_m.empty()) {
    path = planning::plan_outline(*route.space(), T_map_robot, goal, {}, config);
  }
  local.refused = path.reason;
  return local;
}

LocalPath LocalPlanner::plan_on_branches(const SeenScan& scan, const RouteKeeper& route,
                                         const Eigen::Vector2d& robot_m,
                                         std::span<const Eigen::Vector2d> obstacles_m) const {
  LocalPath local;
  const auto detour = detour_along_branches(scan, route.route().points_m, robot_m, obstacles_m,
                                            *route.space(), config_);
  if (!detour) return local;
  local.path = straight_path(detour->points_m);
  if (config_.motion == MotionStyle::kSmooth) {
    constexpr double kCorner_rad = 0.9;  // as in shape()
    const auto smooth = samples_of(rounded(detour->points_m), kCorner_rad);
    if (!blocked(smooth, 0.0, robot_m, obstacles_m, kReach_m)) local.path = smooth;
  }
  if (blocked(local.path, 0.0, robot_m, obstacles_m, kReach_m)) return {};
  local.status = planning::DetourStatus::kFound;
  local.on_branches = true;
  local.on_virtual = detour->is_virtual;
  return local;
}

LocalPath LocalPlanner::plan_on_grid(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                                     std::span<const Eigen::Vector2d> obstacles_m) const {
  LocalPath local;
  if ((route.goal_m() - robot_m).norm() < kNear_m) {
    const std::array<Eigen::Vector2d, 2> line = {robot_m, route.goal_m()};
    local.status = planning::DetourStatus::kClear;
    local.path = straight_path(line);
    return local;
  }
  const planning::FreeSpace& space = *route.space();
  const auto detour_round = [&](std::span<const Eigen::Vector2d> avoided_m) {
    return planning::plan_detour(space, route.cells(), robot_m, route.goal_m(), avoided_m,
                                 config_.detour);
  };
  const auto found = [](const planning::Detour& detour) {
    return detour.status == planning::DetourStatus::kClear ||
           detour.status == planning::DetourStatus::kFound;
  };
  // First with room to spare round the obstacles, then as near to them as the map allows.
  planning::Detour detour = detour_round(widened(obstacles_m, space.frame().resolution_m));
  if (!found(detour) && !obstacles_m.empty()) detour = detour_round(obstacles_m);
  local.status = detour.status;
  if (detour.status == planning::DetourStatus::kClear && route.on_branches()) {
    local.path = along_route(route, robot_m);
    if (!local.path.empty()) return local;
  }
  if (found(detour)) local.path = shape(space, detour.points_m, obstacles_m);
  return local;
}

std::optional<PathBlock> LocalPlanner::blocked(std::span<const planning::PathSample> path,
                                               double from_m, const Eigen::Vector2d& robot_m,
                                               std::span<const Eigen::Vector2d> obstacles_m,
                                               double reach_m) const {
  constexpr double kBeside_m = 0.04;  // distance at which it passes obstacles
  constexpr double kNearer_m = 0.03;  // a larger approach blocks
  constexpr double kStep_m = 0.05;    // as fine as a cell
  const double body_m = config_.guard.radius_m + kBeside_m;
  const auto touched = [&](const Eigen::Vector2d& at_m) {
    return std::find_if(obstacles_m.begin(), obstacles_m.end(), [&](const auto& obstacle_m) {
      return (at_m - obstacle_m).norm() <
             std::min(body_m, (robot_m - obstacle_m).norm() - kNearer_m);
    });
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const double piece_m = path[i + 1].distance_m - path[i].distance_m;
    if (path[i + 1].distance_m < from_m) continue;
    const Eigen::Vector2d begin_m = path[i].T_map_robot.position_m();
    const Eigen::Vector2d vector_m = path[i + 1].T_map_robot.position_m() - begin_m;
    const int steps = std::max(1, static_cast<int>(std::ceil(piece_m / kStep_m)));
    for (int k = 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      const double ahead_m = path[i].distance_m + share * piece_m - from_m;
      if (ahead_m < 0.0) continue;
      if (ahead_m > reach_m) return std::nullopt;
      const auto obstacle = touched(begin_m + share * vector_m);
      if (obstacle != obstacles_m.end()) return PathBlock{ahead_m, *obstacle};
    }
  }
  return std::nullopt;
}

bool passable(const planning::FreeSpace& space, std::span<const planning::PathSample> path,
              double from_m) {
  constexpr double kHere_m = 0.5;  // beyond the reach of a body in forbidden cells
  return std::all_of(path.begin(), path.end(), [&](const planning::PathSample& sample) {
    if (sample.distance_m < from_m + kHere_m) return true;
    const auto cell = space.frame().cell_of(sample.T_map_robot.position_m());
    return cell && space.passable(*cell);
  });
}

}  // namespace topogeo::navigation
