// ROS 2 beside the services of a run: what its command line says of it, and the bridge's part.
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
  std::filesystem::path settings;   ///< see `topogeo-ros-bridge --help`; empty: as they are
  std::vector<std::string> remaps;  ///< FROM:=TO
  std::optional<std::uint32_t> domain;
  double wait_s = 60.0;  ///< for the first scan, to learn where the laser is
};

/// Adds --ros-settings, --remap, --ros-domain and --ros-wait, which go with `needed` alone.
void add_ros_options(command_line::Command& app, RosOptions& options, command_line::Option* needed);

/// Flags of the bridge by which it reaches the nodes.
std::vector<std::string> ros_arguments(const RosOptions& options);

/// Where the transforms of the robot have the laser: asks the bridge, whose output goes to
/// `log_file`. Throws std::runtime_error with what it said when it does not learn that.
geometry::Pose2 mounting_of_ros(const RosOptions& options, const std::vector<std::string>& common,
                                const std::filesystem::path& log_file);

}  // namespace topogeo::cli
