// Options of a run of all services.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/geometry/pose2.hpp"

#include "common/job.hpp"
#include "navigate/goal_session.hpp"
#include "run/ros_run.hpp"
#include "web/web_command_options.hpp"

namespace topogeo::cli {

/// A simulated world with a robot, instead of real devices.
struct SimulatorOptions {
  std::filesystem::path world;  ///< file
  std::uint64_t seed = 1;
  std::string laser_model{devices::laser_models().front().name};
  std::string base_model{devices::base_models().front().name};
  std::uint32_t laser_baud = 500'000;  ///< of a laser with a choice of rates
  std::string odometry = "mild";       ///< see `simulator --help`
  double speed_m_per_s = 0.9;
  std::uint32_t people = 0;
  bool no_laser = false;  ///< sonars only: nothing is mapped or matched
};

/// A drawn floor in which a simulated robot starts: the drawing of its map.
struct DrawnFloor {
  std::filesystem::path world;  ///< file
  std::filesystem::path zones;  ///< file, in the frame of the world
  std::string pose;             ///< of the world frame in the map: X,Y,DEG
};

struct RunOptions {
  JobOptions job;
  std::filesystem::path devices;               ///< devices file; empty: a log
  std::filesystem::path record;                ///< log to write of the mapped data; empty: none
  std::optional<SimulatorOptions> simulation;  ///< devices behind the ports of `devices`
  std::optional<DrawnFloor> floor;
  std::optional<std::string> station;    ///< where a robot without a laser stands
  std::optional<geometry::Pose2> laser;  ///< mounting in use; none: the configured one
  std::uint32_t workers = 2;
  std::optional<std::uint32_t> wait_workers;  ///< before the first step; none: `workers`
  std::uint32_t domain = 0;
  std::string rate = "lossless";
  std::filesystem::path profiles_file;  ///< empty: built in
  bool explore = false;                 ///< the robot explores unknown areas until the end
  std::optional<WebOptions> web;        ///< a page; with a simulation the robot waits for its goals
  std::optional<RosOptions> ros;    ///< ROS nodes; without log and devices their robot is mapped
  std::optional<GoalOptions> goal;  ///< goal in job.map; none: a drive that maps
};

}  // namespace topogeo::cli
