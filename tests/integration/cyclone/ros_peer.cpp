// A robot and its user on ROS 2 topics, by Cyclone DDS.
//
//   ros_peer DOMAIN replay LOG             the robot of a CARMEN log: stands until it is localized,
//   then
//                                          goes on as fast as its poses come back, then stands
//   ros_peer DOMAIN drive WORLD            a simulated robot, in real time, driven by /cmd_vel
//   ros_peer DOMAIN watch                  prints what it hears: map, tf, pose, plan, graph, ...
//   ros_peer DOMAIN listen                 prints what it hears of a robot: scans, odometry, clock,
//   ... ros_peer DOMAIN steer V W              sends velocities as Twist on /cmd_vel ros_peer
//   DOMAIN steer-stamped V W      the same as TwistStamped ros_peer DOMAIN goal X Y YAW sends a
//   goal and ends when a plan has come
//
// One line for each thing, until it is killed. Exit code 1 with a line on standard error when it
// cannot.
#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/world/world.hpp"

#include "diagnostic_msgs.h"
#include "geometry_msgs.h"
#include "map_msgs.h"
#include "nav_msgs.h"
#include "ros_dds.hpp"
#include "rosgraph_msgs.h"
#include "sensor_msgs.h"
#include "tf2_msgs.h"
#include "visualization_msgs.h"

namespace topogeo::test {
namespace {

using Clock = std::chrono::steady_clock;
using Time = builtin_interfaces_msg_dds__Time_;
using Header = std_msgs_msg_dds__Header_;
using PoseStamped = geometry_msgs_msg_dds__PoseStamped_;
using PoseMessage = geometry_msgs_msg_dds__PoseWithCovarianceStamped_;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kStart_ns = 1'700'000'000 * kSecond_ns;

char kOdom[] = "odom";
char kBase[] = "base_link";
char kLaser[] = "laser";
char kMap[] = "map";

Header header(char* frame, std::int64_t stamp_ns) {
  Header out{};
  out.stamp_.sec_ = static_cast<std::int32_t>(stamp_ns / kSecond_ns);
  out.stamp_.nanosec_ = static_cast<std::uint32_t>(stamp_ns % kSecond_ns);
  out.frame_id_ = frame;
  return out;
}

std::int64_t stamp_ns(const Header& of) {
  return of.stamp_.sec_ * kSecond_ns + of.stamp_.nanosec_;
}

double yaw(const geometry_msgs_msg_dds__Quaternion_& q) {
  return std::atan2(2.0 * (q.w_ * q.z_ + q.x_ * q.y_), 1.0 - 2.0 * (q.y_ * q.y_ + q.z_ * q.z_));
}

geometry_msgs_msg_dds__Quaternion_ quaternion(double yaw_rad) {
  geometry_msgs_msg_dds__Quaternion_ q{};
  q.z_ = std::sin(yaw_rad / 2.0);
  q.w_ = std::cos(yaw_rad / 2.0);
  return q;
}

/// Writes what a robot writes.
class RosRobot {
 public:
  explicit RosRobot(std::uint32_t domain)
      : peer_(domain),
        scans_(peer_.writer(sensor_msgs_msg_dds__LaserScan__desc, "/scan", PeerQos::kReliable)),
        odometry_(peer_.writer(nav_msgs_msg_dds__Odometry__desc, "/odom", PeerQos::kReliable)),
        static_(peer_.writer(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static", PeerQos::kLatched)),
        poses_(peer_.reader(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc, "/pose",
                            PeerQos::kReliable)),
        velocities_(
            peer_.reader(geometry_msgs_msg_dds__Twist__desc, "/cmd_vel", PeerQos::kReliable)) {
    geometry_msgs_msg_dds__TransformStamped_ transform{};
    transform.header_ = header(kBase, kStart_ns);
    transform.child_frame_id_ = kLaser;
    transform.transform_.rotation_.w_ = 1.0;
    tf2_msgs_msg_dds__TFMessage_ message{};
    message.transforms_._length = message.transforms_._maximum = 1;
    message.transforms_._buffer = &transform;
    write(static_, message);
  }

  [[nodiscard]] bool has_bridge() const { return has_reader(scans_) && has_reader(odometry_); }

  void send_odometry(std::int64_t at_ns, const geometry::Pose2& T_odom_robot, double linear_mps,
                     double angular_radps) const {
    nav_msgs_msg_dds__Odometry_ message{};
    message.header_ = header(kOdom, at_ns);
    message.child_frame_id_ = kBase;
    message.pose_.pose_.position_.x_ = T_odom_robot.x_m;
    message.pose_.pose_.position_.y_ = T_odom_robot.y_m;
    message.pose_.pose_.orientation_ = quaternion(T_odom_robot.theta_rad);
    message.twist_.twist_.linear_.x_ = linear_mps;
    message.twist_.twist_.angular_.z_ = angular_radps;
    write(odometry_, message);
  }

  void send_scan(std::int64_t at_ns, double angle_min_rad, double angle_step_rad,
                 std::vector<float> ranges_m) const {
    sensor_msgs_msg_dds__LaserScan_ message{};
    message.header_ = header(kLaser, at_ns);
    message.angle_min_ = static_cast<float>(angle_min_rad);
    message.angle_increment_ = static_cast<float>(angle_step_rad);
    message.angle_max_ = static_cast<float>(
        angle_min_rad + angle_step_rad * (static_cast<double>(ranges_m.size()) - 1.0));
    message.range_min_ = 0.01F;
    message.range_max_ = 80.0F;
    for (float& range_m : ranges_m) {
      if (range_m == 0.0F) range_m = INFINITY;
    }
    message.ranges_._length = message.ranges_._maximum =
        static_cast<std::uint32_t>(ranges_m.size());
    message.ranges_._buffer = ranges_m.data();
    write(scans_, message);
  }

  /// Stamp of the newest pose that came back; 0 before the first.
  std::int64_t last_pose_ns() {
    take<PoseMessage>(poses_, [this](const PoseMessage& pose) {
      last_pose_ns_ = std::max(last_pose_ns_, stamp_ns(pose.header_));
    });
    return last_pose_ns_;
  }

  std::optional<simulation::Velocity> velocity() {
    std::optional<simulation::Velocity> last;
    take<geometry_msgs_msg_dds__Twist_>(
        velocities_, [&](const geometry_msgs_msg_dds__Twist_& twist) {
          last = simulation::Velocity{twist.linear_.x_, twist.angular_.z_};
        });
    return last;
  }

 private:
  RosPeer peer_;
  dds_entity_t scans_;
  dds_entity_t odometry_;
  dds_entity_t static_;
  dds_entity_t poses_;
  dds_entity_t velocities_;
  std::int64_t last_pose_ns_ = 0;
};

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
    // Odometry goes on while it waits, as poses come back for each.
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
  simulation::RobotOptions options;
  options.acceleration_m_per_s2 = 1.5;
  options.angular_acceleration_rad_per_s2 = 4.0;
  simulation::SimulatedRobot simulated(world::load_world(world), options);
  const geometry::Pose2 start = simulated.T_world_robot();
  RosRobot robot(domain);
  simulation::Velocity velocity;
  auto last = Clock::now();
  std::int64_t now_ns = kStart_ns;
  for (int step = 0;; ++step) {
    pause_ms(kStep_ms);
    if (const auto told = robot.velocity()) velocity = *told;
    const auto now = Clock::now();
    const std::int64_t passed_ns = std::chrono::nanoseconds(now - last).count();
    last = now;
    now_ns += passed_ns;
    simulated.step(velocity, static_cast<double>(passed_ns) * 1e-9);
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

/// Prints what a user sees.
class Watcher {
 public:
  explicit Watcher(std::uint32_t domain) : peer_(domain) {
    maps_ = peer_.reader(nav_msgs_msg_dds__OccupancyGrid__desc, "/map", PeerQos::kLatched);
    updates_ = peer_.reader(map_msgs_msg_dds__OccupancyGridUpdate__desc, "/map_updates",
                            PeerQos::kReliable);
    transforms_ = peer_.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf", PeerQos::kReliable);
    poses_ = peer_.reader(geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc, "/pose",
                          PeerQos::kReliable);
    plans_ = peer_.reader(nav_msgs_msg_dds__Path__desc, "/plan", PeerQos::kReliable);
    graphs_ =
        peer_.reader(visualization_msgs_msg_dds__MarkerArray__desc, "/graph", PeerQos::kLatched);
    diagnostics_ = peer_.reader(diagnostic_msgs_msg_dds__DiagnosticArray__desc, "/diagnostics",
                                PeerQos::kReliable);
  }

  void print() {
    take<nav_msgs_msg_dds__OccupancyGrid_>(maps_, print_map);
    take<map_msgs_msg_dds__OccupancyGridUpdate_>(
        updates_, [](const map_msgs_msg_dds__OccupancyGridUpdate_& update) {
          std::cout << "map_update " << update.width_ << ' ' << update.height_ << '\n';
        });
    take<tf2_msgs_msg_dds__TFMessage_>(transforms_, print_transforms);
    take<PoseMessage>(poses_, [](const PoseMessage& pose) {
      const auto& at = pose.pose_.pose_;
      std::cout << "pose " << pose.header_.frame_id_ << ' ' << at.position_.x_ << ' '
                << at.position_.y_ << ' ' << yaw(at.orientation_) << ' '
                << pose.pose_.covariance_[0] << '\n';
    });
    take<nav_msgs_msg_dds__Path_>(plans_, [](const nav_msgs_msg_dds__Path_& path) {
      std::cout << "plan " << path.poses_._length << '\n';
    });
    take<visualization_msgs_msg_dds__MarkerArray_>(
        graphs_, [](const visualization_msgs_msg_dds__MarkerArray_& array) {
          std::cout << "graph " << array.markers_._length << '\n';
        });
    take<diagnostic_msgs_msg_dds__DiagnosticArray_>(diagnostics_, print_diagnostics);
    std::cout << std::flush;
  }

 private:
  static void print_map(const nav_msgs_msg_dds__OccupancyGrid_& map) {
    std::uint32_t free = 0;
    std::uint32_t occupied = 0;
    for (std::uint32_t i = 0; i < map.data_._length; ++i) {
      free += map.data_._buffer[i] == 0 ? 1 : 0;
      occupied += map.data_._buffer[i] == 100 ? 1 : 0;
    }
    std::cout << "map " << map.header_.frame_id_ << ' ' << map.info_.width_ << ' '
              << map.info_.height_ << ' ' << map.info_.resolution_ << ' ' << free << ' ' << occupied
              << ' '
              << (map.data_._length == map.info_.width_ * map.info_.height_ ? "whole" : "cut")
              << '\n';
  }

  static void print_transforms(const tf2_msgs_msg_dds__TFMessage_& message) {
    for (std::uint32_t i = 0; i < message.transforms_._length; ++i) {
      const auto& transform = message.transforms_._buffer[i];
      std::cout << "tf " << transform.header_.frame_id_ << ' ' << transform.child_frame_id_ << ' '
                << transform.transform_.translation_.x_ << ' '
                << transform.transform_.translation_.y_ << ' '
                << yaw(transform.transform_.rotation_) << '\n';
    }
  }

  static void print_diagnostics(const diagnostic_msgs_msg_dds__DiagnosticArray_& array) {
    for (std::uint32_t i = 0; i < array.status_._length; ++i) {
      std::cout << "diagnostics " << array.status_._buffer[i].name_ << ' '
                << static_cast<int>(array.status_._buffer[i].level_) << '\n';
    }
  }

  RosPeer peer_;
  dds_entity_t maps_;
  dds_entity_t updates_;
  dds_entity_t transforms_;
  dds_entity_t poses_;
  dds_entity_t plans_;
  dds_entity_t graphs_;
  dds_entity_t diagnostics_;
};

/// Prints what the sensors of a robot are to a node.
int listen(std::uint32_t domain) {
  const RosPeer peer(domain);
  const dds_entity_t scans =
      peer.reader(sensor_msgs_msg_dds__LaserScan__desc, "/scan", PeerQos::kSensor);
  const dds_entity_t odometry =
      peer.reader(nav_msgs_msg_dds__Odometry__desc, "/odom", PeerQos::kSensor);
  const dds_entity_t transforms =
      peer.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf", PeerQos::kReliable);
  const dds_entity_t fixed =
      peer.reader(tf2_msgs_msg_dds__TFMessage__desc, "/tf_static", PeerQos::kLatched);
  const dds_entity_t clock =
      peer.reader(rosgraph_msgs_msg_dds__Clock__desc, "/clock", PeerQos::kReliable);
  const auto print_transforms = [](const tf2_msgs_msg_dds__TFMessage_& message) {
    for (std::uint32_t i = 0; i < message.transforms_._length; ++i) {
      const auto& transform = message.transforms_._buffer[i];
      std::cout << "tf " << transform.header_.frame_id_ << ' ' << transform.child_frame_id_ << ' '
                << transform.transform_.translation_.x_ << '\n';
    }
  };
  std::cout << "ready" << std::endl;
  for (;; pause_ms(20)) {
    take<sensor_msgs_msg_dds__LaserScan_>(scans, [](const sensor_msgs_msg_dds__LaserScan_& scan) {
      std::cout << "scan " << scan.header_.frame_id_ << ' ' << scan.ranges_._length << ' '
                << stamp_ns(scan.header_) << '\n';
    });
    take<nav_msgs_msg_dds__Odometry_>(odometry, [](const nav_msgs_msg_dds__Odometry_& message) {
      std::cout << "odom " << message.header_.frame_id_ << ' ' << message.child_frame_id_ << ' '
                << message.pose_.pose_.position_.x_ << '\n';
    });
    take<tf2_msgs_msg_dds__TFMessage_>(transforms, print_transforms);
    take<tf2_msgs_msg_dds__TFMessage_>(fixed, print_transforms);
    take<rosgraph_msgs_msg_dds__Clock_>(clock, [](const rosgraph_msgs_msg_dds__Clock_& message) {
      std::cout << "clock " << message.clock_.sec_ * kSecond_ns + message.clock_.nanosec_ << '\n';
    });
    std::cout << std::flush;
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
  // The plan may come before this reader is known: it is asked for again.
  constexpr int kPatience = 100;
  for (bool planned = false; !planned;) {
    write(goals, goal);
    for (int i = 0; i < kPatience && !planned; ++i) {
      pause_ms(50);
      take<nav_msgs_msg_dds__Path_>(plans, [&](const nav_msgs_msg_dds__Path_& path) {
        planned = planned || path.poses_._length > 0;
      });
    }
  }
  std::cout << "planned" << std::endl;
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
    if (words[1] == "listen" && words.size() == 2) return listen(domain);
    if (words[1].starts_with("steer") && words.size() == 4) {
      return steer(domain, std::stod(words[2]), std::stod(words[3]), words[1] == "steer-stamped");
    }
    if (words[1] == "goal" && words.size() == 5) {
      return send_goal(domain, std::stod(words[2]), std::stod(words[3]), std::stod(words[4]));
    }
    if (words[1] == "watch" && words.size() == 2) {
      Watcher watcher(domain);
      std::cout << "ready" << std::endl;
      for (;; pause_ms(20)) watcher.print();
    }
  }
  std::cerr << "ros_peer: expected DOMAIN and replay LOG, drive WORLD, watch, listen, "
               "steer V W, steer-stamped V W or goal X Y YAW\n";
  return 2;
}
