// Publishes scans and odometry of robot "robot" and obeys motion commands, in place of the sensor
// gateway (docs/publish_your_own.md). The robot here is computed, in a room of 8 m by 5 m.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <numbers>
#include <thread>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

namespace {

namespace messaging = topogeo::messaging;
namespace msg = topogeo::msg;
using Clock = std::chrono::steady_clock;

constexpr const char* kRobot = "robot";
constexpr std::chrono::milliseconds kPeriod{50};
constexpr double kPeriod_s = 0.05;
constexpr int kBeams = 181;
constexpr double kDegree_rad = std::numbers::pi / 180.0;

std::int64_t now_ns() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(since_1970).count();
}

/// Distance to the walls, which are at x = -3 and 5 m and y = -2 and 3 m of the odometry frame.
float range_m(const msg::Pose2& T_odom_robot, double beam_rad) {
  const double x = std::cos(T_odom_robot.theta_rad() + beam_rad);
  const double y = std::sin(T_odom_robot.theta_rad() + beam_rad);
  const double to_x_m = ((x > 0.0 ? 5.0 : -3.0) - T_odom_robot.x_m()) / x;
  const double to_y_m = ((y > 0.0 ? 3.0 : -2.0) - T_odom_robot.y_m()) / y;
  return static_cast<float>(std::min(std::abs(to_x_m), std::abs(to_y_m)));
}

msg::Scan measure(const msg::Pose2& T_odom_robot) {
  msg::Scan scan;
  scan.angle_min_rad(-90.0 * kDegree_rad);
  scan.angle_step_rad(kDegree_rad);
  std::vector<float> ranges_m;
  for (int i = 0; i < kBeams; ++i)
    ranges_m.push_back(range_m(T_odom_robot, (i - 90) * kDegree_rad));
  scan.ranges_m(ranges_m);
  scan.T_odom_robot(T_odom_robot);
  return scan;
}

/// Odometry after another period at these velocities.
msg::Odometry drive(msg::Odometry last, double linear_mps, double angular_radps) {
  msg::Pose2& pose = last.T_odom_robot();
  const double theta_rad = pose.theta_rad();
  pose.x_m(pose.x_m() + linear_mps * kPeriod_s * std::cos(theta_rad));
  pose.y_m(pose.y_m() + linear_mps * kPeriod_s * std::sin(theta_rad));
  pose.theta_rad(std::remainder(theta_rad + angular_radps * kPeriod_s, 2.0 * std::numbers::pi));
  last.linear_mps(linear_mps);
  last.angular_radps(angular_radps);
  return last;
}

}  // namespace

int main() {
  const messaging::Participant participant;  // domain 0, partition "topogeo"
  messaging::Writer<msg::Odometry> odometry_writer(participant);
  messaging::Writer<msg::Scan> scan_writer(participant);
  messaging::Reader<msg::MotionCommand> commands(participant);

  const auto epoch = static_cast<std::uint64_t>(now_ns());  // a new one after each start
  msg::Odometry odometry;
  msg::MotionCommand command;  // of zero: stand
  Clock::time_point stop_at;
  for (std::uint64_t step = 0;; ++step) {
    const Clock::time_point next = Clock::now() + kPeriod;
    commands.take([&](const msg::MotionCommand& received, const messaging::SampleInfo& info) {
      if (!info.valid || received.robot_key() != messaging::key_of(kRobot)) return;
      command = received;
      const std::chrono::duration<double> valid(std::clamp(received.valid_for_s(), 0.0, 0.5));
      stop_at = Clock::now() + std::chrono::duration_cast<Clock::duration>(valid);
    });
    if (Clock::now() >= stop_at) command = msg::MotionCommand();

    odometry = drive(odometry, command.linear_mps(), command.angular_radps());
    odometry.odometry_epoch(epoch);
    const std::int64_t stamp_ns = now_ns();
    messaging::set_header(odometry, kRobot, stamp_ns, step);
    if (!odometry_writer.write(odometry)) std::cerr << "odometry " << step << " not sent\n";
    if (step % 2 == 0) {
      msg::Scan scan = measure(odometry.T_odom_robot());
      scan.odometry_epoch(epoch);
      messaging::set_header(scan, kRobot, stamp_ns, step / 2);
      if (!scan_writer.write(scan)) std::cerr << "scan " << step / 2 << " not sent\n";
    }
    std::this_thread::sleep_until(next);
  }
}
