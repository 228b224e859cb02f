// Where the laser is taken to sit on the robot: as configured, or else as the log states it.
#pragma once

#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"

namespace topogeo::pipeline {

/// Places the laser, with all that follows from it.
void mount_laser(Config& config, const geometry::Pose2& T_robot_laser);

/// Chooses between a configuration and the mounting that a log states, if it states one: a file
/// that sets a key of section `laser` holds, otherwise the log. Returns one line for people: that
/// the mounting is the log's, or that the log contradicts the file by more than 2 cm or 1 degree;
/// empty when there is nothing to report.
std::string choose_mounting(LoadedConfig& config, const std::optional<geometry::Pose2>& in_log);

/// "x,y,yaw" in metres and radians, with every digit, as services take it.
std::string mounting_argument(const geometry::Pose2& T_robot_laser);

/// The mounting of such a text. Throws std::invalid_argument naming what is wrong.
geometry::Pose2 parse_mounting(const std::string& text);

}  // namespace topogeo::pipeline
