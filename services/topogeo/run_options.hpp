// What a run of all services is made of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"

#include "goal_session.hpp"
#include "job.hpp"
#include "ros_run.hpp"
#include "web_command_options.hpp"

namespace topogeo::cli {

/// A world with a robot in place of real devices.
struct SimulatorOptions {
  std::filesystem::path world;  ///< file
  std::uint64_t seed = 1;
  std::uint32_t laser_baud = 500'000;
  std::string odometry = "mild";  ///< see `simulator --help`
  double speed_m_per_s = 0.9;
  std::uint32_t people = 0;
  bool no_laser = false;  ///< sonars alone: nothing is mapped, and nothing matched
};

/// A drawn floor that a simulated robot stands in: the drawing of its map.
struct DrawnFloor {
  std::filesystem::path world;  ///< file
  std::filesystem::path zones;  ///< file, in the frame of the world
  std::string pose;             ///< of the frame of the world in the map: X,Y,DEG
};

struct RunOptions {
  JobOptions job;
  std::filesystem::path devices;               ///< file of the devices to use; empty: a log
  std::filesystem::path record;                ///< log to write of what is mapped; empty: none
  std::optional<SimulatorOptions> simulation;  ///< what is behind the ports of `devices`
  std::optional<DrawnFloor> floor;
  std::optional<std::string> station;    ///< that a robot without a laser stands on
  std::optional<geometry::Pose2> laser;  ///< mounting in force; none: as configured
  std::uint32_t workers = 2;
  std::optional<std::uint32_t> wait_workers;  ///< before the first step; none: `workers`
  std::uint32_t domain = 0;
  std::string rate = "lossless";
  std::filesystem::path profiles_file;  ///< empty: built in
  bool explore = false;                 ///< the robot drives where it has not been, to the end
  std::optional<WebOptions> web;  ///< a page; with a simulation the robot stands until it sends it
  std::optional<RosOptions> ros;  ///< nodes of ROS; without log and devices their robot is mapped
  std::optional<GoalOptions> goal;  ///< to drive to in job.map; none: a drive that maps
};

}  // namespace topogeo::cli
