// Mounting of the laser on the robot: as configured, otherwise as stated in the log.
#pragma once

#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"

namespace topogeo::pipeline {

/// Sets the pose of the laser and everything derived from it.
void mount_laser(Config& config, const geometry::Pose2& T_robot_laser);

/// Chooses between the configuration and the mounting stated in a log, if any: a file that sets a
/// key of section `laser` takes precedence over the log. Returns one line for the user if the
/// mounting comes from the log, or if the log contradicts the file by more than 2 cm or 1 degree;
/// otherwise empty.
std::string choose_mounting(LoadedConfig& config, const std::optional<geometry::Pose2>& in_log);

/// "x,y,yaw" in metres and radians, with all digits, as an argument of services.
std::string mounting_argument(const geometry::Pose2& T_robot_laser);

/// Parses mounting_argument(). Throws std::invalid_argument naming the fault.
geometry::Pose2 parse_mounting(const std::string& text);

}  // namespace topogeo::pipeline
