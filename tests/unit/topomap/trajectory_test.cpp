#include "topogeo/topomap/trajectory.hpp"

#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/topomap/pose_at.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;

constexpr double kQuarterTurn = std::numbers::pi / 2.0;

// Stop 0, two scans on the path, stop 1, one scan, stop 2; odometry drifts.
std::vector<LocalMap> three_stops() {
  std::vector<LocalMap> maps(3);
  for (std::uint32_t i = 0; i < 3; ++i) maps[i].id = i;
  maps[0].sequence = 0;
  maps[0].stamp_ns = 100;
  maps[0].T_odom_robot = {5, 5, kQuarterTurn};
  maps[1].track = {{1, 200, {5, 5.5, kQuarterTurn}, {0.4, 0, 0}, true},
                   {2, 300, {5, 6, kQuarterTurn}, {0.8, 0.1, 0}, true}};
  maps[1].sequence = 3;
  maps[1].stamp_ns = 400;
  maps[1].T_odom_robot = {5, 6.5, kQuarterTurn};
  maps[1].T_previous_robot = {1.2, 0.1, 0};
  maps[2].track = {{4, 500, {5, 7, kQuarterTurn}, {0.5, 0, 0.1}, false}};
  maps[2].sequence = 5;
  maps[2].stamp_ns = 600;
  maps[2].T_odom_robot = {5, 7.5, kQuarterTurn};
  return maps;
}

void expect_pose(const Pose2& pose, double x, double y, double theta) {
  EXPECT_NEAR(pose.x_m, x, 1e-12);
  EXPECT_NEAR(pose.y_m, y, 1e-12);
  EXPECT_NEAR(pose.theta_rad, theta, 1e-12);
}

TEST(ExpandTrajectory, MovesTheScansBetweenWithTheStopBeforeThem) {
  Trajectory trajectory;
  trajectory.stops.resize(3);
  trajectory.stops[1].T_map_robot = {1, 0, kQuarterTurn};
  trajectory.stops[2].T_map_robot = {1, 2, kQuarterTurn};
  const std::vector<StampedPose> poses = expand_trajectory(trajectory, three_stops());
  ASSERT_EQ(poses.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(poses[i].sequence, i);
    EXPECT_EQ(poses[i].stamp_ns, static_cast<std::int64_t>(100 * (i + 1)));
  }
  expect_pose(poses[0].pose, 0, 0, 0);
  expect_pose(poses[1].pose, 0.4, 0, 0);
  expect_pose(poses[2].pose, 0.8, 0.1, 0);
  expect_pose(poses[3].pose, 1, 0, kQuarterTurn);
  expect_pose(poses[4].pose, 1, 0.5, kQuarterTurn + 0.1);
  expect_pose(poses[5].pose, 1, 2, kQuarterTurn);
}

TEST(ExpandTrajectory, NeedsOnePoseForEachMap) {
  Trajectory trajectory;
  trajectory.stops.resize(2);
  EXPECT_THROW(expand_trajectory(trajectory, three_stops()), std::invalid_argument);
}

TEST(ExpandTrajectory, OfNothingIsNothing) {
  EXPECT_TRUE(expand_trajectory({}, {}).empty());
  EXPECT_TRUE(expand_odometry({}).empty());
}

TEST(ExpandTrajectory, LeavesOutStopsThatAreNotLocatedAndTheScansAfterThem) {
  Trajectory trajectory;
  trajectory.stops.resize(3);
  trajectory.stops[1].located = false;
  const std::vector<StampedPose> poses = expand_trajectory(trajectory, three_stops());
  ASSERT_EQ(poses.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(poses[i].sequence, i);
  EXPECT_EQ(poses[3].sequence, 5U);
}

TEST(ExpandOdometry, BeginsEachLaterDriveWhereTheTrajectoryHasIt) {
  std::vector<LocalMap> maps = three_stops();
  maps[2].starts_drive = true;
  maps[2].track.clear();
  Trajectory trajectory;
  trajectory.stops.resize(3);
  trajectory.stops[2].T_map_robot = {7, 8, kQuarterTurn};
  const std::vector<StampedPose> poses = expand_odometry(trajectory, maps);
  ASSERT_EQ(poses.size(), 5U);
  expect_pose(poses[3].pose, 1.5, 0, 0);
  expect_pose(poses[4].pose, 7, 8, kQuarterTurn);
}

TEST(ExpandOdometry, StartsAtTheIdentityAndKeepsTheDrift) {
  const std::vector<StampedPose> poses = expand_odometry(three_stops());
  ASSERT_EQ(poses.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(poses[i].sequence, i);
    expect_pose(poses[i].pose, 0.5 * static_cast<double>(i), 0, 0);
  }
}

TEST(PoseAt, LiesOnTheWayBetweenItsNeighbours) {
  const std::vector<StampedPose> poses = {
      {0, 100, {0, 0, 0}}, {1, 200, {1, 2, kQuarterTurn}}, {2, 900, {1, 3, kQuarterTurn}}};
  EXPECT_EQ(pose_at(poses, 100), poses[0].pose);
  EXPECT_EQ(pose_at(poses, 200), poses[1].pose);
  EXPECT_EQ(pose_at(poses, 900), poses[2].pose);
  const auto between = pose_at(poses, 125);
  ASSERT_TRUE(between);
  expect_pose(*between, 0.25, 0.5, kQuarterTurn / 4);
  EXPECT_FALSE(pose_at(poses, 99));
  EXPECT_FALSE(pose_at(poses, 901));
  EXPECT_TRUE(pose_at(poses, 899));
  EXPECT_FALSE(pose_at(poses, 899, 699));  // they are 700 apart
  EXPECT_FALSE(pose_at({}, 100));
}

}  // namespace
}  // namespace topogeo::topomap
