#include "topogeo/topomap/odometry_contradiction.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::topomap {
namespace {

// Several times the error of usual wheels over the metre between two stops
// (docs/decisions/odometry_contradictions.md).
constexpr double kLeast_m = 0.2;
constexpr double kLeastShare = 0.25;
constexpr double kLeast_rad = 0.5;
// Wheels that stand do not err.
constexpr double kStands = 0.02;  // m or rad
constexpr double kLeastStanding_m = 0.1;
constexpr double kLeastStanding_rad = 0.1;

double length_m(const Eigen::Vector2d& step_m) {
  return std::sqrt(step_m.squaredNorm());
}

}  // namespace

std::optional<OdometryContradiction> odometry_contradiction(const geometry::Pose2& T_odom_previous,
                                                            const LocalMap& map) {
  if (map.track.empty() || !map.track.back().matched) return std::nullopt;
  const geometry::Pose2 odometry = geometry::between(T_odom_previous, map.T_odom_robot);
  const Eigen::Vector3d off = geometry::difference(map.T_previous_robot, odometry);
  const double odometry_m = length_m(odometry.position_m());
  const double scans_m = length_m(map.T_previous_robot.position_m());
  const double off_m = length_m(off.head<2>());
  const bool stands = odometry_m < kStands && std::fabs(odometry.theta_rad) < kStands;
  const double least_m =
      stands ? kLeastStanding_m : kLeast_m + kLeastShare * std::max(odometry_m, scans_m);
  const double least_rad = stands ? kLeastStanding_rad : kLeast_rad;
  if (off_m <= least_m && std::fabs(off.z()) <= least_rad) return std::nullopt;
  return OdometryContradiction{odometry_m, scans_m, off.z()};
}

}  // namespace topogeo::topomap
