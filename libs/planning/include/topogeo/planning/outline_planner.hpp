// Paths for a robot that is not round: a search over poses that keeps the whole outline free, on
// straight lines, while it reverses, and while it turns on the spot.
//
// Hybrid A* (Dolgov, Thrun, Montemerlo and Diebel 2010) over positions and headings with the length
// of the shortest path of the centre as its estimate. Motions are straight pieces ahead and back
// and turns on the spot. Near the goal the search tries to turn, drive straight and turn; at the
// end the same shortens the path. Turns happen only where the swept outline is free, so a long
// robot enters a narrow door straight. A base that cannot turn on the spot gets arcs instead, ahead
// and back, with a tenth more than its radius; near the goal the search tries the shortest words of
// arcs and lines (src/arc_paths.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::planning {

struct OutlineConfig {
  geometry::Footprint footprint;  ///< has corners
  /// Least distance of the outline from the centres of occupied cells, metres: half a cell, and the
  /// error of pose and follower.
  double margin_m = 0.08;
  double wished_m = 0.25;  ///< the same where there is room, metres
  /// Smallest turning radius of the base, metres; 0: it turns on the spot.
  double minimum_radius_m = 0.0;
};

struct PoseGoal {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  std::optional<double> heading_rad;                     ///< map frame; nothing: any
};

enum class OutlineStatus : std::uint8_t {
  kFound = 0,
  kStartBlocked = 1,  ///< the outline overlaps an obstacle where the robot is
  kGoalBlocked = 2,   ///< it would at the goal, in the wanted heading
  kUnreachable = 3,   ///< no path that the outline fits through
};

struct OutlinePath {
  OutlineStatus status = OutlineStatus::kUnreachable;
  std::string reason;                 ///< one line for people; empty if found
  std::vector<PathSample> samples{};  ///< if found

  [[nodiscard]] bool found() const { return status == OutlineStatus::kFound; }
};

/// A path from the robot's pose to the goal. `obstacles_m`: seen points that are not on the map,
/// map frame. No-go zones count as obstacles, one-way and slow zones are obeyed.
OutlinePath plan_outline(const FreeSpace& space, const geometry::Pose2& T_map_robot,
                         const PoseGoal& goal, std::span<const Eigen::Vector2d> obstacles_m,
                         const OutlineConfig& config);

}  // namespace topogeo::planning
