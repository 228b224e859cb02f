// A user on ROS topics: prints a line for each received message.
#pragma once

#include <cstdint>

#include "ros_dds.hpp"

namespace topogeo::test {

/// Map, transforms, poses, plans, graph, diagnostics and velocities.
class Watcher {
 public:
  explicit Watcher(std::uint32_t domain);

  /// Prints messages received since the last call.
  void print();

 private:
  RosPeer peer_;
  dds_entity_t maps_;
  dds_entity_t updates_;
  dds_entity_t transforms_;
  dds_entity_t poses_;
  dds_entity_t plans_;
  dds_entity_t graphs_;
  dds_entity_t diagnostics_;
  dds_entity_t velocities_;
};

/// Prints scans, odometry, transforms and time of a robot, until it is killed.
[[noreturn]] void print_sensors(std::uint32_t domain);

}  // namespace topogeo::test
