// A robot and its user on ROS 2 topics, with Cyclone DDS.
//
//   ros_peer DOMAIN replay LOG           the robot of a CARMEN log: stands until it is localized,
//                                        drives as fast as its poses come back, then stands again
//   ros_peer DOMAIN drive WORLD          a simulated robot, in real time, driven by /cmd_vel
//   ros_peer DOMAIN watch                prints a user's data: map, tf, pose, plan, graph, velocity
//   ros_peer DOMAIN listen               prints a robot's data: scans, odometry, clock
//   ros_peer DOMAIN steer V W            sends velocities as Twist on /cmd_vel
//   ros_peer DOMAIN steer-stamped V W    the same as TwistStamped
//   ros_peer DOMAIN goal X Y YAW         sends a goal and ends when a plan has come
//   ros_peer DOMAIN initialpose X Y YAW  sends the robot's pose, ends when a pose has come
//
// Prints one line for each message, until it is killed. Exits with 1 and a line on standard error
// when it cannot run.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/world/world.hpp"

#include "nav_msgs.h"
#include "ros_dds.hpp"
#include "ros_messages.hpp"
#include "ros_robot.hpp"
#include "ros_watcher.hpp"

namespace topogeo::test {
namespace {

using Clock = std::chrono::steady_clock;

void send(const RosRobot& robot, const scan::Scan& scan, std::int64_t at_ns) {
  robot.send_odometry(at_ns, scan.T_odom_robot, 0.0, 0.0);
  robot.send_scan(at_ns, scan.angle_min_rad, scan.angle_step_rad, scan.ranges_m);
}

int replay(std::uint32_t domain, const std::string& log) {
  constexpr std::int64_t kScan_ns = 100'000'000;
  constexpr std::int64_t kAhead_ns = 20 * kScan_ns;
  RosRobot robot(domain);
  while (!robot.has_bridge()) pause_ms(20);
  std::cout << "connected" << std::endl;
  scan::CarmenLogReader reader(log);
  std::optional<scan::Scan> scan = reader.next();
  std::int64_t now_ns = kStart_ns;
  const auto stand = [&] {
    send(robot, *scan, now_ns += kScan_ns);
    pause_ms(50);
  };
  while (robot.last_pose_ns() == 0) stand();
  std::cout << "localized" << std::endl;
  for (auto next = reader.next(); next; next = reader.next()) {
    scan = next;
    send(robot, *scan, now_ns += kScan_ns);
    // It keeps sending odometry while it waits, because each sample brings a pose back.
    for (std::int64_t waited = 1; robot.last_pose_ns() < now_ns - kAhead_ns; ++waited) {
      pause_ms(20);
      constexpr std::int64_t kMillisecond_ns = 1'000'000;
      if (waited % 10 == 0 && waited / 10 < kScan_ns / kMillisecond_ns) {
        robot.send_odometry(now_ns + waited / 10 * kMillisecond_ns, scan->T_odom_robot, 0.0, 0.0);
      }
    }
  }
  std::cout << "driven" << std::endl;
  for (;;) stand();
}

int drive(std::uint32_t domain, const std::string& world) {
  constexpr int kStep_ms = 20;
  constexpr int kStepsOfScan = 5;
  // Like the base of a robot, it stops soon after the last velocity.
  constexpr std::int64_t kValid_ns = 500'000'000;
  // When a busy machine gives this process no time for longer, the robot does not move for the
  // rest, because a robot that runs on blindly would hit something.
  constexpr std::int64_t kLongestMotion_ns = 200'000'000;
  simulation::RobotOptions options;
  options.acceleration_m_per_s2 = 1.5;
  options.angular_acceleration_rad_per_s2 = 4.0;
  simulation::SimulatedRobot simulated(world::load_world(world), options);
  const geometry::Pose2 start = simulated.T_world_robot();
  RosRobot robot(domain);
  simulation::Velocity velocity;
  auto last = Clock::now();
  std::int64_t now_ns = kStart_ns;
  std::int64_t valid_until_ns = kStart_ns;
  for (int step = 0;; ++step) {
    pause_ms(kStep_ms);
    const auto now = Clock::now();
    const std::int64_t passed_ns = std::chrono::nanoseconds(now - last).count();
    last = now;
    now_ns += passed_ns;
    if (const auto received = robot.velocity()) {
      velocity = *received;
      valid_until_ns = now_ns + kValid_ns;
    }
    if (now_ns > valid_until_ns) velocity = {};
    simulated.step(velocity, static_cast<double>(std::min(passed_ns, kLongestMotion_ns)) * 1e-9);
    robot.send_odometry(now_ns, simulated.T_odom_robot(), simulated.velocity().linear_m_per_s,
                        simulated.velocity().angular_rad_per_s);
    if (step % kStepsOfScan != 0) continue;
    const simulation::BeamPattern& beams = simulated.options().beams;
    robot.send_scan(now_ns, beams.angle_min_rad, beams.angle_step_rad, simulated.scan());
    const geometry::Pose2 at = geometry::between(start, simulated.T_world_robot());
    const bool stands = simulated.velocity() == simulation::Velocity{};
    std::cout << "truth " << at.x_m << ' ' << at.y_m << ' ' << at.theta_rad << ' '
              << (stands ? "stands" : "moves") << " collisions " << simulated.collisions()
              << std::endl;
  }
}

int steer(std::uint32_t domain, double linear_mps, double angular_radps, bool stamped) {
  const RosPeer peer(domain);
  const dds_entity_t velocities = peer.writer(
      stamped ? geometry_msgs_msg_dds__TwistStamped__desc : geometry_msgs_msg_dds__Twist__desc,
      "/cmd_vel", PeerQos::kReliable);
  geometry_msgs_msg_dds__TwistStamped_ message{};
  message.header_ = header(kBase, kStart_ns);
  message.twist_.linear_.x_ = linear_mps;
  message.twist_.angular_.z_ = angular_radps;
  for (;; pause_ms(50)) {
    if (stamped) {
      write(velocities, message);
    } else {
      write(velocities, message.twist_);
    }
  }
}

int send_goal(std::uint32_t domain, double x_m, double y_m, double yaw_rad) {
  const RosPeer peer(domain);
  const dds_entity_t goals =
      peer.writer(geometry_msgs_msg_dds__PoseStamped__desc, "/goal_pose", PeerQos::kReliable);
  const dds_entity_t plans = peer.reader(nav_msgs_msg_dds__Path__desc, "/plan", PeerQos::kReliable);
  while (!has_reader(goals)) pause_ms(20);
  PoseStamped goal{};
  goal.header_ = header(kMap, 0);
  goal.pose_.position_.x_ = x_m;
  goal.pose_.position_.y_ = y_m;
  goal.pose_.orientation_ = quaternion(yaw_rad);
  // The plan may be sent before this reader is matched, so the request is repeated.
  constexpr int kLooks = 100;
  for (bool planned = false; !planned;) {
    write(goals, goal);
    for (int i = 0; i < kLooks && !planned; ++i) {
      pause_ms(50);
      take<nav_msgs_msg_dds__Path_>(plans, [&](const nav_msgs_msg_dds__Path_& path) {
        planned = planned || path.poses_._length > 0;
      });
    }
  }
  std::cout << "planned" << std::endl;
  return 0;
}

/// Uses RViz's covariance: half a metre, 15 degrees.
int send_initial_pose(std::uint32_t domain, double x_m, double y_m, double yaw_rad) {
  const RosPeer peer(domain);
  const dds_entity_t out = peer.writer(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
                                       "/initialpose", PeerQos::kReliable);
  const dds_entity_t in = peer.reader(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
                                      "/pose", PeerQos::kReliable);
  while (!has_reader(out)) pause_ms(20);
  PoseMessage pose{};
  pose.header_ = header(kMap, 0);
  pose.pose_.pose_.position_.x_ = x_m;
  pose.pose_.pose_.position_.y_ = y_m;
  pose.pose_.pose_.orientation_ = quaternion(yaw_rad);
  constexpr std::size_t kXX = 0;
  constexpr std::size_t kYY = 7;
  constexpr std::size_t kYawYaw = 35;
  pose.pose_.covariance_[kXX] = 0.25;
  pose.pose_.covariance_[kYY] = 0.25;
  pose.pose_.covariance_[kYawYaw] = 0.0685;
  write(out, pose);
  for (bool came = false; !came; pause_ms(20)) {
    take<PoseMessage>(in, [&](const PoseMessage&) { came = true; });
  }
  std::cout << "localized" << std::endl;
  return 0;
}

}  // namespace
}  // namespace topogeo::test

int main(int argc, char** argv) {
  using namespace topogeo::test;  // NOLINT(google-build-using-namespace)
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() >= 2) {
    const auto domain = static_cast<std::uint32_t>(std::stoul(words[0]));
    if (words[1] == "replay" && words.size() == 3) return replay(domain, words[2]);
    if (words[1] == "drive" && words.size() == 3) return drive(domain, words[2]);
    if (words[1] == "listen" && words.size() == 2) print_sensors(domain);
    if (words[1].starts_with("steer") && words.size() == 4) {
      return steer(domain, std::stod(words[2]), std::stod(words[3]), words[1] == "steer-stamped");
    }
    if (words[1] == "goal" && words.size() == 5) {
      return send_goal(domain, std::stod(words[2]), std::stod(words[3]), std::stod(words[4]));
    }
    if (words[1] == "initialpose" && words.size() == 5) {
      return send_initial_pose(domain, std::stod(words[2]), std::stod(words[3]),
                               std::stod(words[4]));
    }
    if (words[1] == "watch" && words.size() == 2) {
      Watcher watcher(domain);
      std::cout << "ready" << std::endl;
      for (;; pause_ms(20)) watcher.print();
    }
  }
  std::cerr << "ros_peer: expected DOMAIN and replay LOG, drive WORLD, watch, listen, "
               "steer V W, steer-stamped V W, goal X Y YAW or initialpose X Y YAW\n";
  return 2;
}
