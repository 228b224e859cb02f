// From routes to motion: straight ways, the primitives of spec B2 (advance, turn left, turn right),
// and smooth paths for bases that take velocities.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::planning {

/// Whether the straight line between two points of the map frame stays in passable cells.
bool in_sight(const FreeSpace& space, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m);

/// The way over the middles of neighbouring cells with as few corners as sight allows: points in a
/// line are left out, then every point is that the next but one can be reached without. `from_m`
/// and `to_m` are the exact ends, in or beside the first and last cell. The way stays in passable
/// cells, except from `from_m` to the first and from the last cell to `to_m` where these are not.
std::vector<Eigen::Vector2d> straighten(const FreeSpace& space, std::span<const Cell> cells,
                                        const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);

/// Length of a polyline, metres.
double length_m(std::span<const Eigen::Vector2d> points_m);

enum class MotionKind : std::uint8_t { kAdvance = 0, kTurnLeft = 1, kTurnRight = 2 };

struct MotionPrimitive {
  MotionKind kind = MotionKind::kAdvance;
  double amount = 0.0;  ///< metres of an advance, radians of a turn; > 0
};

struct PrimitiveConfig {
  double min_turn_rad = 1e-3;   ///< smaller turns are left out, [0, 1]; what they add up to is
                                ///< made good at the next turn
  double min_advance_m = 1e-3;  ///< points nearer together count as one, [0, 1]
};

/// Primitives that take a robot along a polyline: `heading_rad` is where it looks at the start,
/// `final_heading_rad` where it shall look in the end. Throws std::invalid_argument for points or
/// angles that are not finite and a configuration out of range.
std::vector<MotionPrimitive> motion_primitives(std::span<const Eigen::Vector2d> points_m,
                                               double heading_rad,
                                               std::optional<double> final_heading_rad = {},
                                               const PrimitiveConfig& config = {});

/// Where primitives take a robot.
geometry::Pose2 pose_after(const geometry::Pose2& T_map_robot,
                           std::span<const MotionPrimitive> primitives);

struct SmoothPathConfig {
  double min_radius_m = 0.2;  ///< tightest arc; corners with no room for it are turned on the spot,
                              ///< [0.01, 10]
  double max_radius_m = 1.0;  ///< arcs are as wide as fits, up to this, [min_radius_m, 100]
  double step_m = 0.1;        ///< between samples at most, [0.005, 10]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const SmoothPathConfig& config);

struct PathSample {
  geometry::Pose2 T_map_robot;    ///< heading along the path, after the turn on the spot
  double distance_m = 0.0;        ///< along the path from its start
  double curvature_per_m = 0.0;   ///< of the path from here on, positive to the left
  double turn_on_spot_rad = 0.0;  ///< to be turned here before going on; 0 nearly everywhere
};

/// Straight lines joined by arcs that touch them, sampled. Arcs stay in passable cells; the
/// curvature is never above 1 / min_radius_m. Empty for less than two different points. Throws
/// std::invalid_argument as `check` and for points that are not finite.
std::vector<PathSample> smooth_path(const FreeSpace& space,
                                    std::span<const Eigen::Vector2d> points_m,
                                    const SmoothPathConfig& config = {});

}  // namespace topogeo::planning
