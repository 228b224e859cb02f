// Odometry whose errors are a multiple of the recorded ones, from a log with a reference.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::simulation {

/// Odometry poses whose every step differs from the true step by `factor` times what the recorded
/// step differs from it: in x, y and heading, in the frame of the step's start. 1 gives the
/// recorded odometry (to rounding), 0 the truth seen from the first recorded pose.
///
/// `T_world_robot` is the true pose of each scan where it is known. Between two known poses the
/// robot is taken to have moved as its odometry reads, and the difference that is left at the
/// second one to have grown evenly with the distance (with the turn where it only turned). Before
/// the first known pose and after the last nothing is known of the error: these steps stay as they
/// are. Throws std::invalid_argument when the sizes differ, fewer than two poses are known or the
/// factor is not in [0, 100].
std::vector<geometry::Pose2> noisier_odometry(
    std::span<const geometry::Pose2> T_odom_robot,
    std::span<const std::optional<geometry::Pose2>> T_world_robot, double factor);

}  // namespace topogeo::simulation
