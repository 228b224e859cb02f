// A navigator in a process of its own with a simulated robot in this one, in real time: this
// process sends the data of gateway, localizer, map store and planner, and the motion commands
// drive the robot.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/hybrid_map.h"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/simulation/simulated_robot.hpp"

#include "program.hpp"

namespace topogeo::test {

class NavigatorOnRobot : public testing::Test {
 protected:
  static constexpr const char* kPartition = "navigator-test";

  NavigatorOnRobot();

  /// Starts the navigator and waits until it is connected and has map and sensors.
  void start();
  /// Sends a goal at a point of the map frame, which is that of the world.
  void send_goal(std::uint64_t id, const Eigen::Vector2d& target_m);
  void send_order(msg::GoalKind kind, std::uint64_t id = 0) { send_order(*goals_, kind, id); }
  /// The same from another client.
  void send_order(messaging::Writer<msg::Goal>& client, msg::GoalKind kind, std::uint64_t id = 0);
  /// Sends an order to the base, as a page does; `stop` is its number.
  void send_base_order(msg::BaseCommandKind kind, std::uint64_t stop);
  /// Kills the navigator and starts the next one beside the living clients.
  void restart();
  /// Sends an order that the navigator drops, and waits until it has. Everything that the client
  /// sent before has arrived by then.
  void expect_silence();
  /// Ends the client that sent the goal.
  void lose_client() { goals_.reset(); }
  /// Makes this process publish as a planner, too.
  void pretend_planner();

  /// Runs the world until `condition` holds.
  template <class Condition>
  bool wait_for(const std::string& what, const Condition& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  /// Runs the world until the program ends; returns its exit code.
  int wait_for_end(Program& program);

  [[nodiscard]] bool is(msg::NavigatorState state) const {
    return status_ && status_->state() == state;
  }
  [[nodiscard]] bool halted(msg::HaltReason reason) const {
    return status_ && status_->reason() == reason;
  }
  /// Whether the robot moves.
  [[nodiscard]] bool rolls() const { return robot_.velocity().linear_m_per_s > 0.1; }
  [[nodiscard]] bool told_to_stand() const {
    return command_ && command_->linear_mps() == 0.0 && command_->angular_radps() == 0.0;
  }
  [[nodiscard]] bool stands() const { return robot_.velocity() == simulation::Velocity{}; }
  /// A counter of the navigator's status; 0 if it has none of that name.
  [[nodiscard]] double counter(std::string_view name) const;
  [[nodiscard]] std::uint64_t drops(std::string_view reason) const;
  [[nodiscard]] std::uint64_t faults(std::string_view reason) const;

  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  Scratch scratch_;
  std::string domain_ = own_domain();
  simulation::SimulatedRobot robot_;
  planning::HybridMap map_;
  msg::LocalizationState pose_state_ = msg::kStateTracking;
  bool poses_come_ = true;
  bool base_reports_ = true;
  std::uint64_t odometry_epoch_ = 0;
  geometry::Pose2 T_odom_start_;    // where the odometry epoch began
  std::string robot_id_ = "robot";  // of what is published
  std::optional<msg::MotionCommand> command_;
  std::uint64_t commands_ = 0;
  std::optional<msg::NavigatorStatus> status_;
  std::optional<msg::ServiceStatus> service_status_;
  std::unique_ptr<Program> navigator_;
  messaging::Handle navigator_writer_;  // of the newest status
  std::filesystem::path memory_;        // of the navigator; empty: none

 private:
  void move();
  void sense();
  void answer(const msg::Goal& goal);
  [[nodiscard]] std::int64_t stamp_ns() const;

  messaging::Participant participant_;

 protected:
  messaging::EventLoop loop_;
  messaging::Writer<msg::LivePose> poses_;

 private:
  std::optional<messaging::Writer<msg::Goal>> goals_;  // empty: the client is gone
  messaging::Writer<msg::Route> routes_;
  messaging::Writer<msg::GridTile> tiles_;
  messaging::Writer<msg::HybridMap> maps_;
  messaging::Writer<msg::Odometry> odometry_;
  messaging::Writer<msg::Scan> scans_;
  messaging::Writer<msg::BaseStatus> bases_;
  messaging::Writer<msg::BaseCommand> base_orders_;
  messaging::Reader<msg::MotionCommand> command_reader_;
  messaging::Reader<msg::NavigatorStatus> status_reader_;
  messaging::Reader<msg::ServiceStatus> service_reader_;
  messaging::Reader<msg::Goal> goal_reader_;
  std::optional<messaging::StatusPublisher> planner_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point command_end_;
  std::int64_t moved_ns_ = 0;
  std::int64_t scan_due_ns_ = 0;
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::test
