#include "route_way.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "topogeo/navigation/path_follower.hpp"

#include "path_band.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kWishedBeside_m = 0.3;  // free beside the body, where there is room
constexpr double kLeastBeside_m = 0.07;  // the same in tight bends
constexpr double kNear_m = 0.3;          // so near to the goal the way is straight

// The cells that a polyline passes, neighbours each.
std::vector<planning::Cell> cells_under(const planning::GridFrame& frame,
                                        const std::vector<Eigen::Vector2d>& points_m) {
  std::vector<planning::Cell> cells;
  const auto add = [&](const Eigen::Vector2d& point_m) {
    const auto cell = frame.cell_of(point_m);
    if (cell && (cells.empty() || !(cells.back() == *cell))) cells.push_back(*cell);
  };
  if (points_m.size() == 1) add(points_m.front());
  for (std::size_t i = 0; i + 1 < points_m.size(); ++i) {
    const Eigen::Vector2d way_m = points_m[i + 1] - points_m[i];
    const int steps =
        std::max(1, static_cast<int>(std::ceil(4.0 * way_m.norm() / frame.resolution_m)));
    for (int k = 0; k <= steps; ++k) add(points_m[i] + static_cast<double>(k) / steps * way_m);
  }
  return cells;
}

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

}  // namespace

RouteWay::RouteWay(const NavigatorConfig& config) : config_(config) {}

bool RouteWay::take(const RoutePlan& route) {
  std::vector<planning::Cell> cells = cells_under(map_->frame(), route.points_m);
  if (cells.empty()) return false;
  route_ = route;
  cells_ = std::move(cells);
  return true;
}

bool RouteWay::fits(const RoutePlan& route) const {
  constexpr double kEnds_m = 0.5;
  const std::vector<planning::Cell> cells = cells_under(map_->frame(), route.points_m);
  return !cells.empty() && std::all_of(cells.begin(), cells.end(), [&](const planning::Cell& cell) {
    const Eigen::Vector2d middle_m = map_->frame().center_m(cell);
    return map_->space().passable(cell) || (middle_m - route.points_m.front()).norm() < kEnds_m ||
           (middle_m - route.points_m.back()).norm() < kEnds_m;
  });
}

void RouteWay::forget() {
  cells_.clear();
  route_ = {};
}

std::vector<planning::PathSample> RouteWay::shape(
    std::span<const Eigen::Vector2d> points_m, std::span<const Eigen::Vector2d> obstacles_m) const {
  if (config_.motion == MotionStyle::kPrimitives) return straight_path(points_m);
  constexpr double kCorner_rad = 0.9;
  const double radius_m = config_.guard.radius_m;
  const BandConfig wished{radius_m + kWishedBeside_m, radius_m + kLeastBeside_m};
  auto banded_m = band(map_->space(), points_m, obstacles_m, wished);
  if (banded_m.empty()) banded_m = band(map_->space(), points_m, {}, wished);
  if (!banded_m.empty()) return samples_of(banded_m, kCorner_rad);
  return planning::smooth_path(map_->space(), points_m, config_.smooth);
}

RouteWay::Local RouteWay::plan(const Eigen::Vector2d& robot_m,
                               std::span<const Eigen::Vector2d> obstacles_m) const {
  Local local;
  if ((goal_m() - robot_m).norm() < kNear_m) {
    const std::array<Eigen::Vector2d, 2> line = {robot_m, goal_m()};
    local.status = planning::DetourStatus::kClear;
    local.path = straight_path(line);
    return local;
  }
  // First with room to spare round the obstacles, then as near to them as the map allows.
  std::vector<Eigen::Vector2d> avoided_m = widened(obstacles_m, map_->frame().resolution_m);
  planning::Detour detour =
      planning::plan_detour(map_->space(), cells_, robot_m, goal_m(), avoided_m, config_.detour);
  const auto found = [&] {
    return detour.status == planning::DetourStatus::kClear ||
           detour.status == planning::DetourStatus::kFound;
  };
  if (!found() && !obstacles_m.empty()) {
    detour = planning::plan_detour(map_->space(), cells_, robot_m, goal_m(), obstacles_m,
                                   config_.detour);
  }
  local.status = detour.status;
  if (found()) local.path = shape(detour.points_m, obstacles_m);
  return local;
}

std::optional<RouteWay::Block> RouteWay::blocked(std::span<const planning::PathSample> path,
                                                 double from_m, const Eigen::Vector2d& robot_m,
                                                 std::span<const Eigen::Vector2d> obstacles_m,
                                                 double reach_m) const {
  constexpr double kBeside_m = 0.04;
  constexpr double kNearer_m = 0.03;
  constexpr double kStep_m = 0.05;
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
    const Eigen::Vector2d way_m = path[i + 1].T_map_robot.position_m() - begin_m;
    const int steps = std::max(1, static_cast<int>(std::ceil(piece_m / kStep_m)));
    for (int k = 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      const double ahead_m = path[i].distance_m + share * piece_m - from_m;
      if (ahead_m < 0.0) continue;
      if (ahead_m > reach_m) return std::nullopt;
      const auto obstacle = touched(begin_m + share * way_m);
      if (obstacle != obstacles_m.end()) return Block{ahead_m, *obstacle};
    }
  }
  return std::nullopt;
}

bool RouteWay::passable(std::span<const planning::PathSample> path, double from_m) const {
  constexpr double kHere_m = 0.5;
  const planning::FreeSpace& space = map_->space();
  return std::all_of(path.begin(), path.end(), [&](const planning::PathSample& sample) {
    if (sample.distance_m < from_m + kHere_m) return true;
    const auto cell = space.frame().cell_of(sample.T_map_robot.position_m());
    return cell && space.passable(*cell);
  });
}

double distance_m(std::span<const planning::PathSample> path, const Eigen::Vector2d& point_m) {
  double least_m = HUGE_VAL;
  for (const planning::PathSample& sample : path) {
    least_m = std::min(least_m, (sample.T_map_robot.position_m() - point_m).norm());
  }
  return least_m;
}

}  // namespace topogeo::navigation
