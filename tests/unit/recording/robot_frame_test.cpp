// The frame of the robot in transforms of drivers that state it in many forms.
#include "robot_frame.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "message_file.hpp"
#include "recorded_drive.hpp"

namespace topogeo::recording {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;
const geometry::Pose2 kBackwards{-0.2, 0.0, kPi};
const geometry::Pose2 kMast{0.1, 0.0, 0.5};

Eigen::Isometry3d lifted(const geometry::Pose2& pose) {
  return Eigen::Translation3d(pose.x_m, pose.y_m, 0.3) *
         Eigen::AngleAxisd(pose.theta_rad, Eigen::Vector3d::UnitZ());
}

/// `parent -> child` on /tf, which moves as the robot drives.
void move(ros::FrameTree& tree, const std::string& parent, const std::string& child) {
  for (int i = 0; i < 3; ++i) tree.add(parent, child, lifted(arc_pose(2.0 + i)), false);
}

/// odom -> base_link -> laser.
ros::FrameTree usual_tree() {
  ros::FrameTree tree;
  move(tree, "odom", "base_link");
  tree.add("base_link", "laser", lifted(kBackwards), true);
  return tree;
}

void expect_mounting(const RobotFrame& robot, const std::string& name,
                     const geometry::Pose2& T_robot_laser) {
  EXPECT_EQ(robot.name, name);
  ASSERT_TRUE(robot.T_robot_laser) << robot.note;
  const geometry::Pose2 found = ros::planar_mounting(*robot.T_robot_laser).T_robot_laser;
  EXPECT_LT(geometry::difference(found, T_robot_laser).norm(), 1e-4);
}

TEST(RobotFrame, IsTheChildOfOdometry) {
  const RobotFrame robot = find_robot_frame(usual_tree(), {"odom", "base_link"}, "laser");
  expect_mounting(robot, "base_link", kBackwards);
  EXPECT_THAT(robot.note, IsEmpty());
}

TEST(RobotFrame, IsFoundByTheTreeIfOdometryStatesAnother) {
  for (const char* child : {"", "robot1/base_link", "odom", "chassis", "map"}) {
    SCOPED_TRACE(child);
    const RobotFrame robot = find_robot_frame(usual_tree(), {"odom", child}, "laser");
    expect_mounting(robot, "base_link", kBackwards);
    EXPECT_THAT(robot.note, HasSubstr("base_link -> laser"));
  }
}

TEST(RobotFrame, IsTheOneThatMovesUnderOdometryAndCarriesTheLaser) {
  ros::FrameTree tree;
  move(tree, "odom", "base_footprint");
  tree.add("base_footprint", "base_link", lifted({0.3, 0.0, 0.0}), true);
  tree.add("base_link", "laser", lifted(kBackwards), true);
  move(tree, "odom", "cart");  // towed
  expect_mounting(find_robot_frame(tree, {"odom", ""}, "laser"), "base_footprint", {0.1, 0.0, kPi});
  // Beside the frame of odometry, which carries nothing.
  move(tree, "odom", "base_foot");
  expect_mounting(find_robot_frame(tree, {"odom", "base_foot"}, "laser"), "base_footprint",
                  {0.1, 0.0, kPi});
}

TEST(RobotFrame, HasAUsualNameIfNothingMoves) {
  ros::FrameTree tree;
  tree.add("base_link", "mast", lifted(kMast), true);
  tree.add("mast", "laser", lifted({}), true);
  for (const char* child : {"", "odom", "base_footprint"}) {
    expect_mounting(find_robot_frame(tree, {"odom", child}, "laser"), "base_link", kMast);
  }
  ros::FrameTree unusual;
  unusual.add("chassis", "laser", lifted(kMast), true);
  expect_mounting(find_robot_frame(unusual, {"odom", ""}, "laser"), "chassis", kMast);
}

TEST(RobotFrame, OfARobotThatStandsIsNotOdometry) {
  ros::FrameTree tree;
  for (int i = 0; i < 3; ++i) tree.add("odom", "base_link", lifted({3.0, 2.0, 1.0}), false);
  tree.add("base_link", "laser", lifted(kBackwards), true);
  for (const char* child : {"", "odom", "base_link"}) {
    expect_mounting(find_robot_frame(tree, {"odom", child}, "laser"), "base_link", kBackwards);
  }
}

TEST(RobotFrame, IsFoundForALaserWithAnotherPrefix) {
  expect_mounting(find_robot_frame(usual_tree(), {"odom", "base_link"}, "robot1/laser"),
                  "base_link", kBackwards);
  // Two lasers of that name.
  ros::FrameTree tree = usual_tree();
  tree.add("base_link", "robot2/laser", lifted(kMast), true);
  EXPECT_FALSE(find_robot_frame(tree, {"odom", "base_link"}, "robot1/laser").T_robot_laser);
}

TEST(RobotFrame, HasNoMountingOfALaserThatMoves) {
  ros::FrameTree tree;
  move(tree, "odom", "base_link");
  move(tree, "base_link", "pan");
  tree.add("pan", "laser", lifted({}), true);
  for (const char* child : {"base_link", "", "odom"}) {
    SCOPED_TRACE(child);
    const RobotFrame robot = find_robot_frame(tree, {"odom", child}, "laser");
    EXPECT_FALSE(robot.T_robot_laser);
    EXPECT_TRUE(robot.laser_moves);
    EXPECT_THAT(robot.note, HasSubstr("base_link -> laser is not constant"));
  }
}

TEST(RobotFrame, HasAMountingThatJitters) {
  ros::FrameTree tree;
  move(tree, "odom", "base_link");
  for (int i = 0; i < 50; ++i) {
    const double wave = std::sin(i);
    tree.add("base_link", "laser", lifted({-0.2 + 0.002 * wave, 0.0, kPi + 0.01 * wave}), false);
  }
  expect_mounting(find_robot_frame(tree, {"odom", "base_link"}, "laser"), "base_link", kBackwards);
}

TEST(RobotFrame, IsUnknownWithoutTransforms) {
  const RobotFrame none = find_robot_frame({}, {"odom", "base_link"}, "laser");
  EXPECT_FALSE(none.T_robot_laser);
  EXPECT_EQ(none.name, "base_link");
  EXPECT_THAT(none.note, HasSubstr("no transforms base_link -> laser"));
  const RobotFrame other = find_robot_frame(usual_tree(), {"odom", "base_link"}, "laser_frame");
  EXPECT_FALSE(other.T_robot_laser);
  EXPECT_THAT(other.note, HasSubstr("there are transforms of base_link, laser, odom"));
  // Another robot's odometry.
  ros::FrameTree two;
  move(two, "a/odom", "a/base_link");
  move(two, "b/odom", "b/base_link");
  two.add("b/base_link", "b/laser", lifted(kMast), true);
  EXPECT_FALSE(find_robot_frame(two, {"a/odom", "a/base_link"}, "b/laser").T_robot_laser);
}

class RecordedFrames : public RecordingFiles {};

// The moving transform must not become a mounting: it leads 3 m away.
TEST_F(RecordedFrames, GiveTheMountingWhateverOdometryStates) {
  for (const char* child : {"base_link", "", "odom", "robot1/base_link"}) {
    SCOPED_TRACE(child);
    MessageFile file(path("a.mcap"));
    file.transform("base_link", "laser", kBackwards, kSecond_ns);
    for (int i = 0; i < 20; ++i) {
      const std::int64_t stamp_ns = (10 + i) * kSecond_ns / 10;
      const geometry::Pose2 T_odom_robot = geometry::Pose2{3.0, 2.0, 1.0} * arc_pose(0.1 * i);
      file.odometry(stamp_ns, stamp_ns, T_odom_robot, child);
      file.transform("odom", "base_link", T_odom_robot, stamp_ns, "/tf");
      file.scan(stamp_ns, stamp_ns, ranges_of(i));
    }
    file.close();
    const LogMounting mounting = mounting_in_log(path("a.mcap"));
    ASSERT_TRUE(mounting.T_robot_laser);
    EXPECT_LT(geometry::difference(*mounting.T_robot_laser, kBackwards).norm(), 1e-4);
    EXPECT_EQ(read_scans(path("a.mcap")).size(), 20U);
  }
}

}  // namespace
}  // namespace topogeo::recording
