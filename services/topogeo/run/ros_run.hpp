// ROS 2 beside the services of a run: its command-line options and the bridge's flags.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::cli {

struct RosOptions {
  std::filesystem::path settings;   ///< see `topogeo-ros-bridge --help`; empty: the defaults
  std::vector<std::string> remaps;  ///< FROM:=TO
  std::optional<std::uint32_t> domain;
  double wait_s = 60.0;  ///< for the first scan, which gives the laser's mounting
};

/// Adds --ros-settings, --remap, --ros-domain and --ros-wait, which require `needed`.
void add_ros_options(command_line::Command& app, RosOptions& options, command_line::Option* needed);

/// Flags of the bridge for reaching the ROS nodes.
std::vector<std::string> ros_arguments(const RosOptions& options);

/// Mounting of the laser by the robot's transforms: asks the bridge, whose output goes to
/// `log_file`. Throws std::runtime_error with that output when the bridge does not find the
/// mounting.
geometry::Pose2 mounting_of_ros(const RosOptions& options, const std::vector<std::string>& common,
                                const std::filesystem::path& log_file);

}  // namespace topogeo::cli
