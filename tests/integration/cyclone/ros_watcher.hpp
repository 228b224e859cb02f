// A user on topics of ROS: prints a line for each thing that it hears.
#pragma once

#include <cstdint>

#include "ros_dds.hpp"

namespace topogeo::test {

/// Map, transforms, poses, plans, graph and diagnostics.
class Watcher {
 public:
  explicit Watcher(std::uint32_t domain);

  /// What came since the last call.
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
};

/// Scans, odometry, transforms and time of a robot, until it is killed.
[[noreturn]] void print_sensors(std::uint32_t domain);

}  // namespace topogeo::test
