// Odometry whose errors are a multiple of the recorded ones, from a log with a reference.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::simulation {

/// Odometry poses with `factor` times the recorded error in every step: in x, y and heading, in the
/// frame of the step's start. 1 gives the recorded odometry (except for rounding), 0 the truth
/// relative to the first recorded pose.
///
/// `T_world_robot` is the true pose of each scan, if known. Between two known poses the robot is
/// assumed to have moved as its odometry reads, with an error that grew evenly with the distance
/// (with the turn if it only turned) to the difference at the second one. Before the first known
/// pose and after the last the error is unknown, so these steps are unchanged. Throws
/// std::invalid_argument if the sizes differ, fewer than two poses are known or the factor is not
/// in [0, 100].
std::vector<geometry::Pose2> noisier_odometry(
    std::span<const geometry::Pose2> T_odom_robot,
    std::span<const std::optional<geometry::Pose2>> T_world_robot, double factor);

}  // namespace topogeo::simulation
