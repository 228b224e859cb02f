// A robot and its user on ROS 2, with Cyclone DDS, with our services behind ros_bridge.
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/storage/tum.hpp"

#include "join.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Words = std::vector<std::string>;

/// The last line that starts with `start`, without that part; empty if there is none.
std::string last_line(const std::string& text, const std::string& start) {
  std::istringstream lines(text);
  std::string found;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(start) && !lines.eof()) found = line.substr(start.size());
  }
  return found;
}

geometry::Pose2 pose_in(const std::string& text) {
  std::istringstream words(text);
  geometry::Pose2 pose;
  words >> pose.x_m >> pose.y_m >> pose.theta_rad;
  return pose;
}

/// Free area in a user's last map; 0 before the first.
double free_m2(const Program& user) {
  std::istringstream map(last_line(user.out(), "map map "));
  int columns = 0;
  int rows = 0;
  double resolution_m = 0.0;
  int free = 0;
  map >> columns >> rows >> resolution_m >> free;
  return free * resolution_m * resolution_m;
}

class RosBridge : public testing::Test {
 protected:
  RosBridge() { use_udp_only(); }

  Program& start(const std::string& service, Words words = {}) {
    const Words common = {"--domain", domain_, "--partition", "ros-test"};
    words.insert(words.begin(), common.begin(), common.end());
    return *programs_.emplace_back(std::make_unique<Program>(scratch_, service, words));
  }
  Program& start_peer(Words words) {
    words.insert(words.begin(), ros_domain());
    return *programs_.emplace_back(std::make_unique<Program>(scratch_, "../tests/ros_peer", words));
  }
  /// ROS and our services may share a domain, because partitions separate them.
  [[nodiscard]] std::string ros_domain() const { return domain_; }

  /// Waits until a program has printed `text`.
  static bool says(const Program& program, const std::string& text) {
    return wait_for("a peer to print '" + text + "'",
                    [&] { return program.out().find(text) != std::string::npos; });
  }

  /// Reliable topics, so that each message of a test arrives.
  void write_settings(const std::string& more = {}) {
    std::ofstream(scratch_ / "ros.yaml") << "qos:\n  scan: reliable\n  odometry: reliable\n"
                                            "odometry:\n  wait_s: 0.5\n"
                                         << more;
  }

  /// Starts all services with one command.
  Program& start_run(Words words) {
    const Words common = {"run",      "--ros",          "--ros-domain", ros_domain(),
                          "--out",    scratch_ / "run", "--workers",    "0",
                          "--domain", domain_};
    words.insert(words.begin(), common.begin(), common.end());
    return *programs_.emplace_back(std::make_unique<Program>(scratch_, "topogeo", words));
  }

  Program& start_bridge() {
    write_settings();
    return start("ros_bridge", {"--ros", scratch_ / "ros.yaml", "--ros-domain", ros_domain()});
  }

  Scratch scratch_;
  std::string domain_ = own_domain();
  std::vector<std::unique_ptr<Program>> programs_;
};

TEST_F(RosBridge, MapsARobotOfRosAndShowsItsMapAndPose) {
  write_log("room", scratch_ / "room.clf", scratch_ / "truth.tum");
  const Program& user = start_peer({"watch"});
  start("map_store", {"--out", scratch_ / "out", "--new"});
  start("localizer", {"--wait-workers", "0"});
  start("local_mapper");
  start_bridge();
  const Program& robot = start_peer({"replay", scratch_ / "room.clf"});
  ASSERT_TRUE(says(robot, "driven")) << robot.out() << programs_[4]->err();

  // The user's pose of the robot must be the end of the true drive, relative to its start.
  const auto truth = storage::read_trajectory_tum(scratch_ / "truth.tum");
  const geometry::Pose2 end = geometry::between(truth.front().pose, truth.back().pose);
  const auto is_at_end = [&] {
    const geometry::Pose2 seen = pose_in(last_line(user.out(), "pose map "));
    return (seen.position_m() - end.position_m()).norm() < 0.1 &&
           std::fabs(geometry::wrap_angle(seen.theta_rad - end.theta_rad)) < 0.05;
  };
  EXPECT_TRUE(wait_for("the pose of the end", is_at_end)) << last_line(user.out(), "pose map ");
  EXPECT_THAT(last_line(user.out(), "tf map odom "), Not(IsEmpty()));
  EXPECT_TRUE(says(user, "diagnostics topogeo: ros_bridge 0"));
  EXPECT_TRUE(wait_for("the graph", [&] { return !last_line(user.out(), "graph ").empty(); }));

  // A late user gets the whole map.
  const Program& late = start_peer({"watch"});
  // The room of 6 x 4 m, without the table and hidden areas.
  EXPECT_TRUE(wait_for("the whole map", [&] { return std::fabs(free_m2(late) - 22.0) < 3.0; }))
      << last_line(late.out(), "map map ");
  EXPECT_THAT(late.out(), HasSubstr(" whole\n"));
  EXPECT_TRUE(wait_for("the graph", [&] { return !last_line(late.out(), "graph ").empty(); }));
}

// Changes within an existing map are sent without a request.
TEST_F(RosBridge, SendsTheChangesOfAMap) {
  start("map_store", {"--out", scratch_ / "out", "--new"});
  start("localizer", {"--wait-workers", "0"});
  start("local_mapper");
  start_bridge();
  const Program& user = start_peer({"watch"});
  start_peer({"drive", std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml"});
  ASSERT_TRUE(says(user, "map map ")) << programs_[3]->err();
  start_peer({"steer", "0", "0.6"});
  EXPECT_TRUE(says(user, "map_update ")) << user.out();
}

TEST_F(RosBridge, DrivesARobotOfRosToAGoal) {
  write_log("room", scratch_ / "room.clf");
  Program map(scratch_, "topogeo",
              {"map", "--log", scratch_ / "room.clf", "--out", scratch_ / "map"});
  ASSERT_EQ(map.wait(), 0) << map.err();
  const std::string stored = scratch_ / "map/map.pb";
  start("map_store", {"--map", stored});
  start("localizer", {"--map", stored, "--initial-pose=0,0,0", "--wait-workers", "0"});
  start("local_mapper", {"--standalone"});
  start("planner");
  start("navigator");
  start_bridge();
  const Program& robot =
      start_peer({"drive", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml"});
  const Program& user = start_peer({"watch"});
  ASSERT_TRUE(says(user, "pose map")) << programs_[5]->err();
  Program& goal = start_peer({"goal", "3", "0", "1.5708"});
  ASSERT_EQ(goal.wait(), 0) << goal.err();
  const auto has_arrived = [&] {
    const std::string truth = last_line(robot.out(), "truth ");
    const geometry::Pose2 at = pose_in(truth);
    return truth.find("stands") != std::string::npos &&
           (at.position_m() - Eigen::Vector2d(3.0, 0.0)).norm() < 0.3 &&
           std::fabs(geometry::wrap_angle(at.theta_rad - 1.5708)) < 0.3;
  };
  EXPECT_TRUE(wait_for("the arrival", has_arrived)) << last_line(robot.out(), "truth ");
  EXPECT_THAT(last_line(robot.out(), "truth "), HasSubstr("collisions 0"));
  EXPECT_THAT(user.out(), HasSubstr("plan "));
}

// A base of ROS keeps its last velocity, and nobody may command another one after the kill.
TEST_F(RosBridge, EndsTheVelocityOfAnEarlierLife) {
  const Program& user = start_peer({"watch"});
  Program& killed = start_bridge();
  const messaging::Participant participant = join(domain_, "ros-test");
  messaging::Writer<msg::MotionCommand> navigator(participant);
  std::uint64_t sent = 0;
  ASSERT_TRUE(wait_for("a velocity", [&] {
    msg::MotionCommand command;
    messaging::set_header(command, "robot", 1, sent++);
    command.linear_mps(0.25);
    command.valid_for_s(0.5);
    static_cast<void>(navigator.write(command));
    return last_line(user.out(), "velocity ") == "0.25 0";
  })) << killed.err();
  killed.send_signal(SIGKILL);
  ASSERT_EQ(killed.wait(), 128 + SIGKILL);
  const Program& next = start_bridge();
  EXPECT_TRUE(wait_for("its end", [&] { return last_line(user.out(), "velocity ") == "0 0"; }))
      << next.err();
}

// In a finished map, as in docs/ros2.md: rooms of this floor look alike, so a standing robot has no
// pose until one is set or it drives on.
class FollowsInAFinishedMap : public RosBridge {
 protected:
  void SetUp() override {
    write_log("floor", scratch_ / "floor.clf");
    Program map(scratch_, "topogeo",
                {"map", "--log", scratch_ / "floor.clf", "--out", scratch_ / "map"});
    ASSERT_EQ(map.wait(), 0) << map.err();
    const std::string stored = scratch_ / "map/map.pb";
    start("map_store", {"--map", stored});
    start("localizer", {"--map", stored, "--wait-workers", "0"});
    start("local_mapper");
    start_bridge();
    robot_ = &start_peer({"drive", std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml"});
    user_ = &start_peer({"watch"});
    ASSERT_TRUE(wait_for("the localizer to need the robot to drive", [&] {
      return status().find(kNeeds) != std::string::npos;
    })) << status();
    ASSERT_EQ(last_line(user_->out(), "pose map "), "");
  }

  std::string status() {
    Program shown(scratch_, "topogeo", {"status", "--domain", domain_, "--partition", "ros-test"});
    (void)shown.wait();
    return shown.out();
  }
  /// Whether the user's pose of the robot is the true one.
  [[nodiscard]] bool agrees() const {
    const geometry::Pose2 apart = geometry::between(pose_in(last_line(robot_->out(), "truth ")),
                                                    pose_in(last_line(user_->out(), "pose map ")));
    return apart.position_m().norm() < 0.15 && std::fabs(apart.theta_rad) < 0.05;
  }

  static constexpr const char* kNeeds = "the robot to drive on, or its pose to be set";
  const Program* robot_ = nullptr;
  const Program* user_ = nullptr;
};

// The pose is as rough as a click; the laser corrects it at the next stop.
TEST_F(FollowsInAFinishedMap, ARobotThatStandsTakesThePoseOfAUser) {
  Program& told = start_peer({"initialpose", "0.3", "-0.2", "0.15"});
  EXPECT_EQ(told.wait(), 0) << told.err();
  ASSERT_TRUE(says(*user_, "pose map "));
  const geometry::Pose2 seen = pose_in(last_line(user_->out(), "pose map "));
  EXPECT_NEAR(seen.x_m, 0.3, 0.05);
  EXPECT_NEAR(seen.y_m, -0.2, 0.05);
  EXPECT_NEAR(seen.theta_rad, 0.15, 0.02);
  EXPECT_TRUE(wait_for("the transform of the odometry",
                       [&] { return !last_line(user_->out(), "tf map odom ").empty(); }));
  EXPECT_TRUE(wait_for("the localizer to need nothing", [&] {
    const std::string shown = status();
    return shown.find("localizer ") != std::string::npos && shown.find(kNeeds) == std::string::npos;
  })) << status();
  start_peer({"steer", "0.3", "0"});
  EXPECT_TRUE(wait_for("the pose that is true", [&] { return agrees(); }))
      << last_line(user_->out(), "pose map ");
}

TEST_F(FollowsInAFinishedMap, ARobotThatDrivesOnIsFound) {
  start_peer({"steer", "0.3", "0"});
  EXPECT_TRUE(says(*user_, "pose map "));
  EXPECT_TRUE(wait_for("the pose that is true", [&] { return agrees(); }))
      << last_line(user_->out(), "pose map ");
}

// `topogeo run --ros` alone: a ROS robot, with the laser mounted as in its transforms.
TEST_F(RosBridge, ARunMapsARobotOfRos) {
  write_log("room", scratch_ / "room.clf");
  write_settings();
  const Program& robot = start_peer({"replay", scratch_ / "room.clf"});
  Program& run = start_run({"--ros-settings", scratch_ / "ros.yaml"});
  ASSERT_TRUE(says(robot, "driven")) << robot.out() << run.err();
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), HasSubstr("laser at 0,0,0: from the transforms"));
  EXPECT_THAT(run.out(), HasSubstr("ROS: "));
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "run/map.pb"));
}

// The other direction: ROS nodes get the sensors and the time of a log.
TEST_F(RosBridge, ARunGivesTheSensorsOfALogToRos) {
  write_log("room", scratch_ / "room.clf");
  const Program& node = start_peer({"listen"});
  const Program& user = start_peer({"watch"});
  ASSERT_TRUE(says(node, "ready"));
  Program& run = start_run({"--log", scratch_ / "room.clf", "--rate", "realtime"});
  for (const char* line : {"scan laser ", "odom odom base_link ", "tf base_link laser 0",
                           "tf odom base_link ", "clock "}) {
    EXPECT_TRUE(says(node, line)) << line << run.err();
  }
  EXPECT_TRUE(says(user, "pose map ")) << run.err();
  // The clock shows the time of scans and odometry.
  const auto scan_has_its_time = [&] {
    const std::string scan = last_line(node.out(), "scan laser ");
    return node.out().find("clock " + scan.substr(scan.find(' ') + 1) + "\n") != std::string::npos;
  };
  EXPECT_TRUE(wait_for("a scan that has its time", scan_has_its_time));
  run.send_signal(SIGINT);
  (void)run.wait();
}

class SteeredByRos : public RosBridge, public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Twists, SteeredByRos, testing::Bool());

// Velocities of ROS nodes, of either type, reach the base.
TEST_P(SteeredByRos, TheBaseGetsTheirVelocity) {
  const bool stamped = GetParam();
  write_settings("directions:\n  sensors: out\n  velocity: in\n" +
                 std::string(stamped ? "velocity:\n  stamped: true\n" : ""));
  start("ros_bridge", {"--ros", scratch_ / "ros.yaml", "--ros-domain", ros_domain()});
  start_peer({stamped ? "steer-stamped" : "steer", "0.25", "-0.5"});
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
  options.partition = "ros-test";
  const messaging::Participant participant(options);
  messaging::Reader<msg::MotionCommand> commands(participant);
  ASSERT_TRUE(wait_by("a command", [&](auto at_most) { return commands.wait_for_data(at_most); }))
      << programs_.front()->err();
  std::size_t came = 0;
  commands.take([&](const msg::MotionCommand& command, const messaging::SampleInfo& info) {
    if (!info.valid) return;
    ++came;
    EXPECT_EQ(command.linear_mps(), 0.25);
    EXPECT_EQ(command.angular_radps(), -0.5);
    EXPECT_GT(command.valid_for_s(), 0.0);
  });
  EXPECT_GT(came, 0U);
}

// The gateway may run on a host with another clock, and the bridge's own may be set at any time.
TEST_F(RosBridge, StampsVelocitiesByTheClockOfTheGateway) {
  write_settings("directions:\n  sensors: out\n  velocity: in\n");
  start("ros_bridge", {"--ros", scratch_ / "ros.yaml", "--ros-domain", ros_domain()});
  start_peer({"steer", "0.25", "-0.5"});
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
  options.partition = "ros-test";
  const messaging::Participant participant(options);
  messaging::Writer<msg::Odometry> gateway(participant);
  messaging::Reader<msg::MotionCommand> commands(participant);
  constexpr std::int64_t kStart_ns = 1'000'000'000'000;  // some minutes after 1970
  std::uint64_t sent = 0;
  std::int64_t newest_ns = 0;
  EXPECT_TRUE(wait_for("a command by that clock", [&] {
    msg::Odometry odometry;
    const std::int64_t stamp_ns = kStart_ns + static_cast<std::int64_t>(sent) * 10'000'000;
    messaging::set_header(odometry, "robot", stamp_ns, sent++);
    odometry.odometry_epoch(1);
    EXPECT_TRUE(gateway.write(odometry));
    commands.take([&](const msg::MotionCommand& command, const messaging::SampleInfo& info) {
      if (info.valid) newest_ns = command.stamp_ns();
    });
    return newest_ns != 0 && newest_ns < 2 * kStart_ns;
  }));
  EXPECT_GE(newest_ns, kStart_ns);
}

// Our side is encrypted, ROS is not, and its scans arrive.
TEST_F(RosBridge, WithSecurityNodesOfRosStayPlainPeers) {
  Program keys(scratch_, "../../deploy/security/make_keys",
               {scratch_ / "keys", "issue", "--robot", "robot", "robot", "ros_bridge", "topogeo"});
  ASSERT_EQ(keys.wait(), 0) << keys.err();
  const std::string material = scratch_ / "keys/robot";
  ::setenv("TOPOGEO_SECURITY", material.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  start_bridge();
  ::unsetenv("TOPOGEO_SECURITY");  // NOLINT(concurrency-mt-unsafe): as above
  start_peer({"drive", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml"});
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
  options.partition = "ros-test";
  options.security = material;
  const messaging::Participant participant(options);
  messaging::Reader<msg::Scan> scans(participant);
  EXPECT_TRUE(wait_by("a scan", [&](auto at_most) { return scans.wait_for_data(at_most); }))
      << programs_.front()->err();
  programs_.front()->send_signal(SIGTERM);
  EXPECT_EQ(programs_.front()->wait(), 0) << programs_.front()->err();
}

}  // namespace
}  // namespace topogeo::test
