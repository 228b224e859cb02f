// Converts routes to motion: straight paths, motion primitives (advance, turn left, turn right),
// and smooth paths for bases that take velocities.
//
// Primitives: MACONDO, III and III.1 (docs/algorithms.md, "Motion primitives").
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/motion_config.hpp"

namespace topogeo::planning {

/// Whether the straight line between two points of the map frame stays in passable cells.
bool in_sight(const FreeSpace& space, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);

/// The path over the centres of neighbouring cells with as few corners as sight allows: collinear
/// points are left out, then every point that lies between two points in sight of each other.
/// `from_m` and `to_m` are the exact ends, in or beside the first and last cell. The path stays in
/// passable cells, except between the exact ends and the end cells if these are impassable there.
std::vector<Eigen::Vector2d> straighten(const FreeSpace& space, std::span<const Cell> cells,
                                        const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);

/// Length of a polyline, metres.
double length_m(std::span<const Eigen::Vector2d> points_m);

enum class MotionKind : std::uint8_t { kAdvance = 0, kTurnLeft = 1, kTurnRight = 2 };

struct MotionPrimitive {
  MotionKind kind = MotionKind::kAdvance;
  double amount = 0.0;  ///< metres of an advance, radians of a turn; > 0
};

/// Primitives that move a robot along a polyline: `heading_rad` is its heading at the start,
/// `final_heading_rad` the wanted one at the end. Throws std::invalid_argument for points or angles
/// that are not finite and a configuration out of range.
std::vector<MotionPrimitive> motion_primitives(std::span<const Eigen::Vector2d> points_m,
                                               double heading_rad,
                                               std::optional<double> final_heading_rad = {},
                                               const PrimitiveConfig& config = {});

/// The robot's pose after the primitives.
geometry::Pose2 pose_after(const geometry::Pose2& T_map_robot,
                           std::span<const MotionPrimitive> primitives);

struct PathSample {
  geometry::Pose2 T_map_robot;    ///< heading along the path, after the turn on the spot
  double distance_m = 0.0;        ///< along the path from its start
  double curvature_per_m = 0.0;   ///< of the path from here on, positive to the left
  double turn_on_spot_rad = 0.0;  ///< turn here before going on; 0 nearly everywhere
  bool backward = false;          ///< the robot faces the other way and reverses from here on
};

/// Straight lines joined by tangential arcs, sampled. Arcs stay in passable cells; the curvature
/// never exceeds 1 / min_radius_m. Empty for fewer than two different points. Throws
/// std::invalid_argument like `check` and for points that are not finite.
std::vector<PathSample> smooth_path(const FreeSpace& space,
                                    std::span<const Eigen::Vector2d> points_m,
                                    const SmoothPathConfig& config = {});

}  // namespace topogeo::planning
