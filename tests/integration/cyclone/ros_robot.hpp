// A robot on ROS topics: sends scans and odometry, its laser at its middle; receives velocities.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/simulated_robot.hpp"

#include "ros_dds.hpp"

namespace topogeo::test {

class RosRobot {
 public:
  explicit RosRobot(std::uint32_t domain);

  [[nodiscard]] bool has_bridge() const;

  void send_odometry(std::int64_t at_ns, const geometry::Pose2& T_odom_robot, double linear_mps,
                     double angular_radps) const;
  /// A range of 0 is no echo.
  void send_scan(std::int64_t at_ns, double angle_min_rad, double angle_step_rad,
                 std::vector<float> ranges_m) const;

  /// Stamp of the newest received pose; 0 before the first.
  std::int64_t last_pose_ns();

  /// The newest velocity received since the last call.
  std::optional<simulation::Velocity> velocity();

 private:
  RosPeer peer_;
  dds_entity_t scans_;
  dds_entity_t odometry_;
  dds_entity_t static_;
  dds_entity_t poses_;
  dds_entity_t velocities_;
  std::int64_t last_pose_ns_ = 0;
};

}  // namespace topogeo::test
