// Plans the robot's path to its route and along it: round obstacles that are not on the map, with
// rounded corners, and off the walls.
#pragma once

#include <optional>
#include <span>
#include <string>
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
  std::vector<planning::PathSample> path;  ///< if clear or found
  bool on_branches = false;                ///< found along branches of the scan
  bool on_virtual = false;                 ///< along virtual ones
  /// Why the outline fits along no path even without obstacles; empty if that is not so.
  std::string refused;
};

/// The first place on a path where the robot would touch an obstacle.
struct PathBlock {
  double ahead_m = 0.0;  ///< of the robot, along the path
  Eigen::Vector2d obstacle_m = Eigen::Vector2d::Zero();
};

class LocalPlanner {
 public:
  explicit LocalPlanner(const NavigatorConfig& config) : config_(config) {}

  /// The path from the robot to the goal, round the obstacles (map frame): on the grid, or, if that
  /// has none, along branches of the scan, if given. `route` has a floor and a route.
  [[nodiscard]] LocalPath plan(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                               std::span<const Eigen::Vector2d> obstacles_m,
                               const std::optional<SeenScan>& scan = {}) const;

  /// The same for a robot that is not round: a path along which its whole outline is free.
  [[nodiscard]] LocalPath plan_outline(const RouteKeeper& route, const geometry::Pose2& T_map_robot,
                                       std::span<const Eigen::Vector2d> obstacles_m) const;

  /// The first place after `from_m` along a path where the body would come too near to an obstacle;
  /// nothing if there is none within `reach_m`. An obstacle near the robot blocks only motion that
  /// leads nearer to it.
  [[nodiscard]] std::optional<PathBlock> blocked(std::span<const planning::PathSample> path,
                                                 double from_m, const Eigen::Vector2d& robot_m,
                                                 std::span<const Eigen::Vector2d> obstacles_m,
                                                 double reach_m) const;

 private:
  [[nodiscard]] LocalPath plan_on_grid(const RouteKeeper& route, const Eigen::Vector2d& robot_m,
                                       std::span<const Eigen::Vector2d> obstacles_m) const;
  /// No path if the branches lead nowhere, or too near to an obstacle.
  [[nodiscard]] LocalPath plan_on_branches(const SeenScan& scan, const RouteKeeper& route,
                                           const Eigen::Vector2d& robot_m,
                                           std::span<const Eigen::Vector2d> obstacles_m) const;
  /// The unchanged route along branches; empty if there is no room.
  [[nodiscard]] std::vector<planning::PathSample> along_route(const RouteKeeper& route,
                                                              const Eigen::Vector2d& robot_m) const;
  [[nodiscard]] std::vector<planning::PathSample> shape(
      const planning::FreeSpace& space, std::span<const Eigen::Vector2d> points_m,
      std::span<const Eigen::Vector2d> obstacles_m) const;

  const NavigatorConfig& config_;
};

/// Whether a path stays in passable cells from `from_m` on. Its first half metre may be in
/// forbidden cells, where the robot already is.
bool passable(const planning::FreeSpace& space, std::span<const planning::PathSample> path,
              double from_m);

}  // namespace topogeo::navigation
