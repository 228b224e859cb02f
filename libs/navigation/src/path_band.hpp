// Turns a straightened path into one that is good to drive: rounded, and as far from obstacles as
// is useful.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

struct BandConfig {
  double wished_m = 0.57;  ///< between the path and any obstacle, if there is room
  double least_m = 0.33;   ///< the same in tight bends, at least
};

/// The room that paths of a robot with this guard keep beside its body.
BandConfig band_of(const GuardConfig& guard);

/// An elastic band (Quinlan and Khatib 1993) from the first to the last point: pulled straight, and
/// pushed off obstacles within the wished distance. Empty if a part of it would leave the passable
/// cells or the path leads through an obstacle; callers then use the path unchanged.
std::vector<Eigen::Vector2d> band(const planning::FreeSpace& space,
                                  std::span<const Eigen::Vector2d> points_m,
                                  std::span<const Eigen::Vector2d> obstacles_m,
                                  const BandConfig& config);

/// A line of two or more points with rounded corners, otherwise unchanged.
std::vector<Eigen::Vector2d> rounded(std::span<const Eigen::Vector2d> points_m);

/// Whether a line stays in passable cells. Its first and last 0.4 m are exempt, because robot and
/// goal may be in forbidden ones.
bool stays_in(const planning::FreeSpace& space, const std::vector<Eigen::Vector2d>& path_m);

/// Samples of a dense polyline with the curvature of the circle through each three points; corners
/// sharper than `corner_rad` become turns on the spot.
std::vector<planning::PathSample> samples_of(std::span<const Eigen::Vector2d> points_m,
                                             double corner_rad);

}  // namespace topogeo::navigation
