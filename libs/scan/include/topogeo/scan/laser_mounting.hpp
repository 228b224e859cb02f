// Where the laser sits on the robot, as a CARMEN log states it: each laser line has the pose of the
// laser and, after it, that of the robot.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::scan {

/// T_robot_laser of a log; all zeros when its lines give one pose twice. Empty when the log does
/// not state it: fewer than ten scans of a moving robot, damaged poses, or two poses that differ by
/// no constant, as where the first is that of a corrected trajectory. Reads the whole log.
/// Throws std::runtime_error when the file cannot be opened.
std::optional<geometry::Pose2> mounting_in_log(const std::filesystem::path& log);

/// The pose that nine in ten of the given poses agree with, to 1 cm and 0.5 degrees: their median,
/// rounded to 0.1 mm and 0.00001 rad, so that noise in the last digits of a log leaves no trace.
/// Empty when there is none, for fewer than ten poses, and for one over 5 m from the robot.
std::optional<geometry::Pose2> common_mounting(std::span<const geometry::Pose2> T_robot_laser);

}  // namespace topogeo::scan
