// Plans the path that the robot follows from where it is to its route and along it: round what is
// not on the map, rounded, and off the walls.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/local_detour.hpp"
#include "topogeo/planning/motion_primitives.hpp"

#include "branch_detour.hpp"
#include "route_keeper.hpp"

namespace topogeo::navigation {

struct LocalPath {
  planning::DetourStatus status = planning::DetourStatus::kLost;
  std::vector<planning::PathSample> path;  ///< when clear or found
  bool on_branches = false;                ///< found along branches of the scan
  bool on_virtual = false;                 ///< along virtual ones
};

/// The place on a path where the robot would touch an obstacle.
struct PathBlock {
  double ahead_m = 0.0;  ///< of the robot, along the path
  Eigen::Vector2d obstacle_m = Eigen::Vector2d::Zero();
};

class LocalPlanner {
 public:
  explicit LocalPlanner(const NavigatorConfig& config) : config_(config) {}

  /// The path from the robot to the goal, round the obstacles (map frame): on the grid, and where
  /// that has none along branches of the scan, if there is one. `route` has a floor and a route.
  [[nodiscard]] LocalPath plan(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                               std::span<const Eigen::Vector2d> obstacles_m,
                               const std::optional<SeenScan>& scan = {}) const;

  /// The first place after `from_m` along a path where the body would come too near to one of the
  /// obstacles; nothing when there is none within `reach_m`. An obstacle that the robot is near to
  /// already blocks only what leads nearer.
  [[nodiscard]] std::optional<PathBlock> blocked(std::span<const planning::PathSample> path,
                                                 double from_m, const Eigen::Vector2d& robot_m,
                                                 std::span<const Eigen::Vector2d> obstacles_m,
                                                 double reach_m) const;

 private:
  [[nodiscard]] LocalPath plan_on_grid(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                                       std::span<const Eigen::Vector2d> obstacles_m) const;
  /// Without a path where the branches lead nowhere, or too near to an obstacle.
  [[nodiscard]] LocalPath plan_on_branches(const SeenScan& scan, const RouteKeeper& route,
                                           const Eigen::Vector2d& robot_m,
                                           std::span<const Eigen::Vector2d> obstacles_m) const;
  /// Along a route on branches as it is; empty where there is no room.
  [[nodiscard]] std::vector<planning::PathSample> along_route(const RouteKeeper& route,
                                                              const Eigen::Vector2d& robot_m) const;
  [[nodiscard]] std::vector<planning::PathSample> shape(
      const planning::FreeSpace& space, std::span<const Eigen::Vector2d> points_m,
      std::span<const Eigen::Vector2d> obstacles_m) const;

  const NavigatorConfig& config_;
};

/// Whether a path from `from_m` on stays in passable cells. Its first half metre may be in
/// forbidden ones: there the robot is already.
bool passable(const planning::FreeSpace& space, std::span<const planning::PathSample> path,
              double from_m);

}  // namespace topogeo::navigation
