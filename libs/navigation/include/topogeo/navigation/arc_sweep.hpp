// How far a round body gets along an arc before it touches points.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"

namespace topogeo::navigation {

struct SweptArc {
  double length_m = 0.0;               ///< of the body's middle along the arc, >= 0
  std::optional<std::size_t> contact;  ///< index of the point that ends it; nothing: the limit does
};

/// The disc of radius `radius_m` around the origin moves along the arc of `motion` (ahead or back
/// by the sign of linear_m_per_s), at most `limit_m`. Points are in the robot's frame. What it
/// overlaps already ends the arc at once when the motion brings it nearer, and does not count when
/// it does not. Without linear motion the length is the limit.
SweptArc sweep(const geometry::Velocity& motion, std::span<const Eigen::Vector2d> points_m,
               double radius_m, double limit_m);

/// The speed from which it stops within `distance_m` when it brakes that hard after a delay: v with
/// v delay + v^2 / (2 brake) = distance. 0 for a distance that is not above 0.
double stopping_speed(double distance_m, double delay_s, double brake_m_per_s2);

/// Where the robot is after `time_s` of a constant velocity, seen from where it was.
geometry::Pose2 moved(const geometry::Velocity& velocity, double time_s);

}  // namespace topogeo::navigation
