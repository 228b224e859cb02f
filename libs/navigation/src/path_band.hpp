// Turns a straightened path into one that a robot likes to drive: rounded, and as far from what it
// could touch as is useful.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

struct BandConfig {
  double wished_m = 0.57;  ///< between the path and whatever could be touched, where there is room
  double least_m = 0.33;   ///< tight bends are made wider until it is only this
};

/// An elastic band (Quinlan and Khatib 1993) from the first to the last point: pulled straight, and
/// pushed off everything that is nearer than wished. Empty when a part of it would leave the
/// passable cells or the path leads through an obstacle; then the path as it is must do.
std::vector<Eigen::Vector2d> band(const planning::FreeSpace& space,
                                  std::span<const Eigen::Vector2d> points_m,
                                  std::span<const Eigen::Vector2d> obstacles_m,
                                  const BandConfig& config);

/// A line with its corners rounded, and otherwise where it was; of two points or more.
std::vector<Eigen::Vector2d> rounded(std::span<const Eigen::Vector2d> points_m);

/// Whether a line stays in passable cells. Its first and last 0.4 m need not: robot and goal may be
/// in forbidden ones.
bool stays_in(const planning::FreeSpace& space, const std::vector<Eigen::Vector2d>& path_m);

/// Samples of a dense polyline with the curvature of the circle through three points each; corners
/// sharper than `corner_rad` are turned on the spot.
std::vector<planning::PathSample> samples_of(std::span<const Eigen::Vector2d> points_m,
                                             double corner_rad);

}  // namespace topogeo::navigation
