// Mounting of the laser on the robot according to a CARMEN log: each laser line contains the pose
// of the laser, followed by that of the robot.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::scan {

/// T_robot_laser of a log; all zeros if its lines repeat one pose. If the difference of both poses
/// is not constant, as when the first is that of a corrected trajectory, the motions between the
/// lines show it, to about a centimetre. Empty if the log does not state it: fewer than ten scans
/// of a moving robot, damaged poses, or two poses that have nothing to do with each other. Reads
/// the whole log. Throws std::runtime_error if the file cannot be opened.
std::optional<geometry::Pose2> mounting_in_log(const std::filesystem::path& log);

/// The pose that nine in ten of the given poses agree with, to 1 cm and 0.5 degrees: their median,
/// rounded to 0.1 mm and 0.00001 rad to remove noise in the last digits of a log. Empty if there is
/// none, for fewer than ten poses, and for a pose over 5 m from the robot.
std::optional<geometry::Pose2> common_mounting(std::span<const geometry::Pose2> T_robot_laser);

}  // namespace topogeo::scan
