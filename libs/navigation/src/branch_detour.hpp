// Detours on the momentary local map (Thesis, 1.1 and 4.2.1; docs/algorithms.md, "Driving and
// collision guard").
//
// The branches of the newest scan's Voronoi diagram keep the largest distance to everything that
// the laser sees now, and need no map: they lead through floor that the grid shows as blocked, for
// example where furniture was removed. If the scan shows fewer than two groups of objects, its
// diagram is virtual and leads on.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::navigation {

/// A scan and the robot's pose at its time.
struct SeenScan {
  std::shared_ptr<const scan::Scan> scan;
  geometry::Pose2 T_robot_laser;
  geometry::Pose2 T_map_robot;
};

/// Nodes and branches of the scan's diagram, map frame. Ids are indices.
topomap::GlobalMap branches_of(const SeenScan& seen, const NavigatorConfig& config);

struct BranchDetour {
  std::vector<Eigen::Vector2d> points_m;  ///< from the robot along branches and the route
  bool is_virtual = false;                ///< a part of it follows a virtual branch
};

/// The shortest detour along branches of the scan and back to the route (points of the map frame),
/// behind the last place where that touches an obstacle or a point of the scan, and on to its end.
/// Avoids obstacles, assumes hidden floor to be free, and obeys no-go and one-way zones. Empty if
/// no branch leads to a place with a straight line back to the route.
std::optional<BranchDetour> detour_along_branches(const SeenScan& seen,
                                                  std::span<const Eigen::Vector2d> route_m,
                                                  const Eigen::Vector2d& robot_m,
                                                  std::span<const Eigen::Vector2d> obstacles_m,
                                                  const planning::FreeSpace& floor,
                                                  const NavigatorConfig& config);

}  // namespace topogeo::navigation
