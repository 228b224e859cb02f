// Free motion of a body that is not round before its outline touches points: ahead, back, on arcs
// and on the spot.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/velocity.hpp"

namespace topogeo::navigation {

/// Largest speed of any place of the body at this motion, m/s: what a stop must brake.
double outline_speed(const geometry::Velocity& motion, const geometry::Footprint& footprint);

struct OutlineSweep {
  double reach_m = 0.0;   ///< distance at outline_speed() until a contact, at most the limit
  double length_m = 0.0;  ///< of the body's middle in the same time
  std::optional<std::size_t> contact;  ///< index of the point that ends it; nothing: the limit does
};

/// Moves the outline, widened by `margin_m` (>= 0), until it touches a point (robot frame), at most
/// for `limit_m` at outline_speed(). A point already within the margin ends the motion at once if
/// that brings it nearer, and is ignored otherwise. Without motion the reach is the limit.
OutlineSweep sweep(const geometry::Velocity& motion, std::span<const Eigen::Vector2d> points_m,
                   const geometry::Footprint& footprint, double margin_m, double limit_m);

}  // namespace topogeo::navigation
