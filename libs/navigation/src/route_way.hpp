// The planner's route, and the path that the robot follows to it and along it from where it is.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/local_detour.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

class RouteWay {
 public:
  explicit RouteWay(const NavigatorConfig& config);

  void set_map(std::shared_ptr<const planning::HybridMap> map) { map_ = std::move(map); }

  /// Whether a route of another map has room in this one, its ends apart.
  [[nodiscard]] bool fits(const RoutePlan& route) const;

  /// Takes a route that was found; false when none of its points is on the map.
  bool take(const RoutePlan& route);
  void forget();
  [[nodiscard]] bool has_route() const { return !cells_.empty(); }
  [[nodiscard]] const RoutePlan& route() const { return route_; }
  [[nodiscard]] const Eigen::Vector2d& goal_m() const { return route_.points_m.back(); }

  struct Local {
    planning::DetourStatus status = planning::DetourStatus::kLost;
    std::vector<planning::PathSample> path;  ///< when clear or found
  };
  /// The path from the robot to the goal, round the obstacles (map frame). Needs map and route.
  [[nodiscard]] Local plan(const Eigen::Vector2d& robot_m,
                           std::span<const Eigen::Vector2d> obstacles_m) const;

  /// How far after `from_m` along a path the body would come too near to one of the obstacles, and
  /// which one; nothing when it does not within `reach_m`. An obstacle that the robot is near to
  /// already blocks only what leads nearer.
  struct Block {
    double ahead_m = 0.0;
    Eigen::Vector2d obstacle_m = Eigen::Vector2d::Zero();
  };
  [[nodiscard]] std::optional<Block> blocked(std::span<const planning::PathSample> path,
                                             double from_m, const Eigen::Vector2d& robot_m,
                                             std::span<const Eigen::Vector2d> obstacles_m,
                                             double reach_m) const;

  /// Whether the path from `from_m` on stays in passable cells of the map. Its first half metre
  /// may be in forbidden ones: there the robot is already.
  [[nodiscard]] bool passable(std::span<const planning::PathSample> path, double from_m) const;

 private:
  [[nodiscard]] std::vector<planning::PathSample> shape(
      std::span<const Eigen::Vector2d> points_m,
      std::span<const Eigen::Vector2d> obstacles_m) const;

  const NavigatorConfig& config_;
  std::shared_ptr<const planning::HybridMap> map_;
  RoutePlan route_;
  std::vector<planning::Cell> cells_;
};

/// Distance from a point to the nearest place of a path; infinity for an empty one.
double distance_m(std::span<const planning::PathSample> path, const Eigen::Vector2d& point_m);

}  // namespace topogeo::navigation
