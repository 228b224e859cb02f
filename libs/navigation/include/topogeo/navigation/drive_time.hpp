// The time that a drive along a path takes, before it begins or on the way.
//
// A speed profile along the path: each sample has a largest speed, by the follower, the curve and
// the speed limit there; between samples the base speeds up and brakes. Turns on the spot are
// added. Obstacles, the guard and corrections at the goal are not foreseen.
// `unit_navigation` (DriveTime) and topogeo_drive_times drive through slow zones and compare.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

/// The speed limits of slow zones at the samples of a path, m/s; infinity without one.
std::vector<double> limits_along(const planning::FreeSpace& space,
                                 std::span<const planning::PathSample> path);

/// Seconds from each sample until the robot stands at the end of the path; it stands at the first
/// sample. `limits_m_per_s`: one for each sample, or none.
std::vector<double> rest_times_s(std::span<const planning::PathSample> path,
                                 std::span<const double> limits_m_per_s,
                                 const FollowerConfig& config);

/// Seconds for a route along its points until the robot stands at the last one. `heading_rad`:
/// of the robot at the start, if known. `space` has the walls and slow zones, null: there are none.
double drive_time_s(std::span<const Eigen::Vector2d> points_m, std::optional<double> heading_rad,
                    const planning::FreeSpace* space, const NavigatorConfig& config);

}  // namespace topogeo::navigation
