#include <gtest/gtest.h>

#include "topogeo/relocalization/map_tracker.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

const Eigen::Matrix3d kCovariance = Eigen::Vector3d(4e-4, 4e-4, 1e-4).asDiagonal();
const UncertainPose kStop{{2.0, 1.0, 0.0}, kCovariance};
const Pose2 kOdomStop{10.0, 0.0, 0.0};

void expect_near(const Pose2& got, const Pose2& wanted) {
  EXPECT_NEAR(got.x_m, wanted.x_m, 1e-12);
  EXPECT_NEAR(got.y_m, wanted.y_m, 1e-12);
  EXPECT_NEAR(got.theta_rad, wanted.theta_rad, 1e-12);
}

TEST(LivePose, IsThatOfTheStopAndTheOdometrySince) {
  const UncertainPose now = live_pose(kStop, kOdomStop, nullptr, {10.5, 0.1, 0.2}, {});
  expect_near(now.T_a_b, {2.5, 1.1, 0.2});
  EXPECT_GT(now.covariance(2, 2), kCovariance(2, 2));
}

TEST(LivePose, AMatchedScanStandsInForTheOdometryUpToIt) {
  topomap::TrackedScan scan;
  scan.T_odom_robot = {10.5, 0.1, 0.2};
  scan.T_stop_robot = {0.45, 0.0, 0.15};
  scan.matched = true;
  expect_near(live_pose(kStop, kOdomStop, &scan, scan.T_odom_robot, {}).T_a_b, {2.45, 1.0, 0.15});
  const UncertainPose turned = live_pose(kStop, kOdomStop, &scan, {10.5, 0.1, 0.3}, {});
  expect_near(turned.T_a_b, {2.45, 1.0, 0.25});
  const UncertainPose odometry = live_pose(kStop, kOdomStop, nullptr, {10.5, 0.1, 0.3}, {});
  EXPECT_LT(turned.covariance(2, 2), odometry.covariance(2, 2));
}

TEST(LivePose, AScanThatWasNotMatchedSaysNothing) {
  topomap::TrackedScan scan;
  scan.T_odom_robot = {10.5, 0.1, 0.2};
  scan.T_stop_robot = {5.0, 5.0, 3.0};
  const UncertainPose now = live_pose(kStop, kOdomStop, &scan, {10.5, 0.1, 0.2}, {});
  expect_near(now.T_a_b, {2.5, 1.1, 0.2});
}

}  // namespace
}  // namespace topogeo::localization
