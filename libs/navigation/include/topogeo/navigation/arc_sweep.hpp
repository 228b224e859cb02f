// Free distance of a round body along an arc before it touches points.
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

/// Moves the disc of radius `radius_m` around the origin along the arc of `motion` (ahead or back
/// by the sign of linear_m_per_s), at most `limit_m`. Points are in the robot's frame. A point
/// already inside the disc ends the arc at once if the motion brings it nearer, and is ignored
/// otherwise. Without linear motion the length is the limit.
SweptArc sweep(const geometry::Velocity& motion, std::span<const Eigen::Vector2d> points_m,
               double radius_m, double limit_m);

/// The highest speed that allows a stop within `distance_m`, braking after a delay: v with v delay
/// + v^2 / (2 brake) = distance. 0 unless the distance is above 0.
double stopping_speed(double distance_m, double delay_s, double brake_m_per_s2);

/// The robot's pose after `time_s` at a constant velocity, relative to its first pose.
geometry::Pose2 moved(const geometry::Velocity& velocity, double time_s);

}  // namespace topogeo::navigation
