// Finds steps between stops over which odometry cannot be right, because the scans show another
// motion: a wheel that spun while the robot stood, a robot that was carried while its wheels stood.
#pragma once

#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap {

struct OdometryContradiction {
  double odometry_m = 0.0;  ///< from the previous stop to this one
  double scans_m = 0.0;     ///< the same by scan tracking
  double turn_rad = 0.0;    ///< turn by scan tracking less that by odometry, in [-pi, pi]
};

/// Compares odometry with scan tracking from the previous stop, taken at `T_odom_previous` of the
/// same odometry epoch, to a stop. Tracking leaves the robot to odometry where no scan contradicts
/// it, so that the two differ little otherwise: beyond 0.2 m and a quarter of the longer of both
/// steps, or 0.5 rad, scan tracking is right; while the wheels stand, beyond 0.1 m or 0.1 rad.
/// Empty if they differ less, or if the last scan before the stop is not matched: without scans
/// between two stops nothing contradicts odometry.
std::optional<OdometryContradiction> odometry_contradiction(const geometry::Pose2& T_odom_previous,
                                                            const LocalMap& map);

}  // namespace topogeo::topomap
