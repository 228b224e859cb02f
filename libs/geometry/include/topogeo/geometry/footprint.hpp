// Outline of a robot that is not round: the one type that guard, planner, follower and simulator
// share.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace topogeo::geometry {

/// A simple polygon in the robot's frame, metres, in either sense of rotation. Without corners the
/// robot is round.
struct Footprint {
  std::vector<Eigen::Vector2d> corners_m;

  static constexpr std::size_t kMostCorners = 32;
  static constexpr double kFarthest_m = 3.0;         ///< of a corner from the origin
  static constexpr double kLeastInscribed_m = 0.05;  ///< a smaller body is a mistake in the unit

  friend bool operator==(const Footprint&, const Footprint&) = default;

  [[nodiscard]] bool empty() const { return corners_m.empty(); }
};

/// Distance from a point (robot frame) to the outline, metres; negative inside. The footprint has
/// corners.
double signed_distance_m(const Footprint& footprint, const Eigen::Vector2d& point_m);

/// Radius of the largest disc around the origin inside of the outline; 0 without corners.
double inscribed_radius_m(const Footprint& footprint);

/// Radius of the smallest disc around the origin that contains the outline; 0 without corners.
double circumscribed_radius_m(const Footprint& footprint);

/// Points that cover the body so that none of its places is farther than `spacing_m` (> 0) from
/// one: the corners, points along the edges, and a grid inside. The outline comes first.
std::vector<Eigen::Vector2d> covering_points_m(const Footprint& footprint, double spacing_m);

/// Why the footprint is unusable: fewer than 3 or more than kMostCorners corners, a corner that is
/// not finite or too far away, edges that touch each other, an origin outside of it or nearer to
/// the outline than kLeastInscribed_m. Empty for a usable one and for a round robot.
std::string fault_of(const Footprint& footprint);

}  // namespace topogeo::geometry
