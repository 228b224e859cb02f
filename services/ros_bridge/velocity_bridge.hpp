// Carries velocities: our navigator's to the base of ROS, or those of ROS to our base.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/service/command_ages.hpp"
#include "topogeo/service/stamp_clock.hpp"
#include "topogeo/support/record_file.hpp"

#include "ros_side.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service. A base of ROS keeps its last velocity, so a zero follows a
/// velocity whose time ends without another one, and zeros follow when a killed bridge starts
/// again; a velocity of ROS holds for half a second.
class VelocityBridge {
 public:
  explicit VelocityBridge(RosSide& ros);
  VelocityBridge(const VelocityBridge&) = delete;
  VelocityBridge& operator=(const VelocityBridge&) = delete;
  /// The same as stop().
  ~VelocityBridge();

  /// Call it after the loop: stops a base of ROS that is moving, and waits a moment until it has
  /// the order.
  void stop();

 private:
  void give();
  /// Ends the last velocity of a bridge that was killed, once the base is connected.
  void end_earlier();
  void take();
  void on_command(const msg::MotionCommand& command);
  void on_twist(const ros::Twist& twist, const messaging::SampleInfo& info);
  /// Whether a velocity has just been sent; an older one is counted as dropped.
  bool is_of_the_moment(const messaging::SampleInfo& info);
  void send(double linear_mps, double angular_radps);
  /// Stores whether the base may have a velocity.
  void remember(bool moving);
  /// Number of readers of the velocity, one of which may be the base.
  [[nodiscard]] int matched() const;

  RosSide& ros_;
  std::optional<messaging::Writer<ros::Twist>> twists_;
  std::optional<messaging::Writer<ros::TwistStamped>> stamped_;
  std::optional<messaging::Writer<msg::MotionCommand>> commands_;
  service::StampClock clock_;                                 // of the gateway, by its odometry
  service::CommandAges ages_;                                 // of velocities of ROS
  std::optional<support::RecordFile<std::uint64_t>> memory_;  // 1: the base has a velocity
  bool remembered_ = false;                                   // in memory_
  std::uint64_t earlier_timer_ = 0;
  int zeros_left_ = 0;  // of end_earlier()
  int readers_ = 0;     // matched() at the last of them
  bool moving_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::ros_bridge
