#include "localizer/live_pose_estimate.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace topogeo::localizer {
namespace {

using geometry::Pose2;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::uint64_t kEpoch = 5;

/// A stop at one second, after 10 m of odometry.
std::shared_ptr<const topomap::LocalMap> stop_at_10_m(std::uint32_t id) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->id = id;
  map->stop = {1, id};
  map->sequence = 7;
  map->stamp_ns = kSecond_ns;
  map->T_odom_robot = {10.0, 0.0, 0.0};
  map->odometry_epoch = kEpoch;
  return map;
}

/// The stop is at (2, 3) of the map, and the robot faces y.
topomap::StopPose corrected() {
  topomap::StopPose pose;
  pose.T_map_robot = {2.0, 3.0, 0.5 * 3.141592653589793};
  pose.covariance = Eigen::Matrix3d::Identity() * 1e-4;
  return pose;
}

class LivePose : public ::testing::Test {
 protected:
  void expect_at(double x_m, double y_m) {
    const std::optional<PoseOfNow> now = live_.now();
    ASSERT_TRUE(now);
    EXPECT_NEAR(now->T_map_robot.T_a_b.x_m, x_m, 1e-9);
    EXPECT_NEAR(now->T_map_robot.T_a_b.y_m, y_m, 1e-9);
  }

  LivePoseEstimate live_{localization::OdometryNoise{}};
};

TEST_F(LivePose, IsUnknownBeforeTheFirstStop) {
  live_.set_odometry(kSecond_ns, 1, {1.0, 0.0, 0.0}, kEpoch);
  EXPECT_FALSE(live_.has_stop());
  EXPECT_FALSE(live_.now());
  EXPECT_EQ(live_.T_stop_robot(), Pose2{});
}

// When a log is read again, its readings come again.
TEST_F(LivePose, KnowsWhichReadingsAreOld) {
  EXPECT_FALSE(live_.has_newer(0, kEpoch));
  live_.set_odometry(kSecond_ns, 1, {1.0, 0.0, 0.0}, kEpoch);
  EXPECT_TRUE(live_.has_newer(kSecond_ns - 1, kEpoch));
  EXPECT_FALSE(live_.has_newer(kSecond_ns, kEpoch));
  EXPECT_FALSE(live_.has_newer(kSecond_ns - 1, kEpoch + 1)) << "another log";
}

TEST_F(LivePose, IsThatOfTheStopAndTheOdometrySince) {
  live_.set_stop(stop_at_10_m(0));
  live_.correct(corrected());
  expect_at(2.0, 3.0);
  EXPECT_EQ(live_.now()->stamp_ns, kSecond_ns);
  EXPECT_EQ(live_.now()->sequence, 7U);
  live_.set_odometry(2 * kSecond_ns, 9, {10.5, 0.0, 0.0}, kEpoch);
  expect_at(2.0, 3.5);
  EXPECT_EQ(live_.now()->sequence, 9U);
  EXPECT_NEAR(live_.T_stop_robot().x_m, 0.5, 1e-12);
}

TEST_F(LivePose, IsUnknownFromANewEpochOfTheOdometryToTheNextStop) {
  live_.set_stop(stop_at_10_m(0));
  live_.correct(corrected());
  live_.set_odometry(2 * kSecond_ns, 9, {0.0, 0.0, 0.0}, kEpoch + 1);  // the base was restarted
  EXPECT_FALSE(live_.now());
  EXPECT_EQ(live_.T_stop_robot(), Pose2{});
  auto next = std::make_shared<topomap::LocalMap>(*stop_at_10_m(1));
  next->odometry_epoch = kEpoch + 1;
  next->T_odom_robot = {};
  live_.set_stop(next);
  live_.set_odometry(3 * kSecond_ns, 10, {0.25, 0.0, 0.0}, kEpoch + 1);
  expect_at(2.0, 3.25);
}

TEST_F(LivePose, NewerOdometryThanThatOfTheStopStays) {
  live_.set_odometry(2 * kSecond_ns, 9, {10.5, 0.0, 0.0}, kEpoch);
  live_.set_stop(stop_at_10_m(0));  // its match took a second
  live_.correct(corrected());
  expect_at(2.0, 3.5);
}

TEST_F(LivePose, AScanMatchedWithTheLastStopReplacesItsOdometry) {
  live_.set_stop(stop_at_10_m(4));
  live_.correct(corrected());
  topomap::TrackedScan scan;
  scan.T_odom_robot = {10.5, 0.0, 0.0};
  scan.T_stop_robot = {0.4, 0.0, 0.0};  // the odometry was off by 0.1 m
  scan.matched = true;
  live_.set_odometry(2 * kSecond_ns, 9, {10.6, 0.0, 0.0}, kEpoch);
  live_.set_tracked({1, 3}, scan);  // relative to the previous stop
  expect_at(2.0, 3.6);
  live_.set_tracked({1, 4}, scan);
  expect_at(2.0, 3.5);
}

TEST_F(LivePose, MovesWithACorrection) {
  live_.set_stop(stop_at_10_m(0));
  live_.correct(corrected());
  live_.set_odometry(2 * kSecond_ns, 9, {10.5, 0.0, 0.0}, kEpoch);
  live_.correct(Pose2{5.0, 0.0, 0.0}, Eigen::Matrix3d::Identity());
  expect_at(5.5, 0.0);
  EXPECT_GT(live_.now()->T_map_robot.covariance(0, 0), 0.9);
}

}  // namespace
}  // namespace topogeo::localizer
