#include "topogeo/service/navigation_conversions.hpp"

#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

TEST(NavigationConversions, AStatusComesBackAsItWas) {
  navigation::NavigatorStatus status;
  status.state = navigation::NavigatorState::kBlocked;
  status.reason = navigation::HaltReason::kObstacle;
  status.message = "something stands in the way";
  status.goal_id = 77;
  status.driven_m = 1.5;
  status.rest_m = 2.5;
  status.rest_s = 6.0;
  status.T_map_robot = geometry::Pose2{1.0, -2.0, 0.5};
  status.command = {0.25, -0.5};
  status.free_ahead_m = 4.0;
  status.detours = 2;
  status.routes = 3;
  status.branch_detours = 5;
  status.virtual_detours = 4;
  status.guard_stops = 1;
  const msg::NavigatorStatus message = to_msg(status, "r2", 42, 9);
  EXPECT_EQ(message.state(), msg::kNavigatorBlocked);
  EXPECT_EQ(message.reason(), msg::kHaltObstacle);
  EXPECT_EQ(message.robot_id().to_string(), "r2");
  const navigation::NavigatorStatus back = from_msg(message);
  EXPECT_EQ(back.state, status.state);
  EXPECT_EQ(back.reason, status.reason);
  EXPECT_EQ(back.message, status.message);
  EXPECT_EQ(back.goal_id, 77U);
  EXPECT_EQ(back.driven_m, 1.5);
  EXPECT_EQ(back.rest_m, 2.5);
  EXPECT_EQ(back.rest_s, 6.0);
  ASSERT_TRUE(back.T_map_robot.has_value());
  EXPECT_EQ(back.T_map_robot->y_m, -2.0);
  EXPECT_EQ(back.command, status.command);
  EXPECT_EQ(back.free_ahead_m, 4.0);
  EXPECT_EQ(back.detours, 2U);
  EXPECT_EQ(back.routes, 3U);
  EXPECT_EQ(back.branch_detours, 5U);
  EXPECT_EQ(back.virtual_detours, 4U);
  EXPECT_EQ(back.guard_stops, 1U);
}

TEST(NavigationConversions, AnUncertainPoseAtAKnownPlaceIsToldFromADoubtfulOne) {
  using localization::LocalizationState;
  LivePose pose;
  pose.mode = msg::kModeLocalization;
  pose.covariance.diagonal() << 1.0, 0.01, 1e-6;  // a metre along a corridor
  pose.status = {LocalizationState::kAmbiguous, 0.08};
  EXPECT_TRUE(to_pose_fix(pose).place_known);
  EXPECT_FALSE(to_pose_fix(pose).tracking);
  pose.status.confidence = 0.02;
  EXPECT_FALSE(to_pose_fix(pose).place_known);
  pose.covariance.diagonal() << 1e-4, 1e-4, 1e-6;  // certain, but perhaps elsewhere
  pose.status.confidence = 0.3;
  EXPECT_FALSE(to_pose_fix(pose).place_known);
  pose.status.confidence = 0.7;
  EXPECT_TRUE(to_pose_fix(pose).place_known);
  pose.mode = msg::kModeMapping;
  EXPECT_FALSE(to_pose_fix(pose).place_known);
  pose.mode = msg::kModeLocalization;
  pose.status = {LocalizationState::kLost, 0.7};
  EXPECT_FALSE(to_pose_fix(pose).place_known);
}

TEST(NavigationConversions, APoseThatIsNotKnownStaysSo) {
  EXPECT_FALSE(from_msg(to_msg(navigation::NavigatorStatus{}, "r", 0, 0)).T_map_robot.has_value());
}

TEST(NavigationConversions, EveryStateAndReasonHasItsNumber) {
  EXPECT_EQ(static_cast<int>(msg::kNavigatorStopped),
            static_cast<int>(navigation::NavigatorState::kStopped));
  EXPECT_EQ(static_cast<int>(msg::kHaltBaseStuck),
            static_cast<int>(navigation::HaltReason::kBaseStuck));
}

TEST(NavigationConversions, BlockagesComeBackAndTooManyAreRefused) {
  navigation::BlockageReport report{5, {{1.0, 2.0}, {-3.0, 0.5}}};
  const navigation::BlockageReport back = from_msg(to_msg(report, "r", 1, 2));
  EXPECT_EQ(back.version, 5U);
  EXPECT_EQ(back.points_m, report.points_m);
  report.points_m.resize(msg::kMaxBlockedPoints + 1, Eigen::Vector2d::Zero());
  EXPECT_THROW(to_msg(report, "r", 1, 2), std::invalid_argument);
  msg::Blockages broken = to_msg(back, "r", 1, 2);
  broken.points().at(1).y_m(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(from_msg(broken), std::invalid_argument);
}

TEST(NavigationConversions, BeamsEndWhereTheLaserSitsOnTheRobot) {
  scan::Scan scan;
  scan.angle_min_rad = 0.0;
  scan.angle_step_rad = std::numbers::pi / 2.0;
  scan.ranges_m = {2.0F, scan::Scan::kNoReturn, 1.0F};
  // 0.1 m ahead of the robot's centre, facing left.
  const navigation::ScanPoints points = to_scan_points(scan, {0.1, 0.0, std::numbers::pi / 2.0});
  ASSERT_EQ(points.points_m.size(), 2U);
  EXPECT_LT((points.points_m[0] - Eigen::Vector2d(0.1, 2.0)).norm(), 1e-12);
  EXPECT_LT((points.points_m[1] - Eigen::Vector2d(0.1, -1.0)).norm(), 1e-12);
}

TEST(NavigationConversions, SonarsWithoutAConeOrWithNegativeRangesAreRefused) {
  msg::Sonar message;
  message.echoes().resize(1);
  message.echoes()[0].range_m(1.5F);
  message.echoes()[0].half_cone_rad(0.2F);
  EXPECT_EQ(sonar_from_msg(message).readings.at(0).range_m, 1.5F);
  message.echoes()[0].half_cone_rad(0.0F);
  EXPECT_THROW(sonar_from_msg(message), std::invalid_argument);
  message.echoes()[0].half_cone_rad(0.2F);
  message.echoes()[0].range_m(-1.0F);
  EXPECT_THROW(sonar_from_msg(message), std::invalid_argument);
}

TEST(NavigationConversions, OnlyATrackedPoseIsOneToDriveBy) {
  LivePose pose;
  pose.status.state = localization::LocalizationState::kTracking;
  EXPECT_TRUE(to_pose_fix(pose).tracking);
  pose.status.state = localization::LocalizationState::kAmbiguous;
  EXPECT_FALSE(to_pose_fix(pose).tracking);
  EXPECT_EQ(to_pose_fix(pose).state_text, "AMBIGUOUS");
}

TEST(NavigationConversions, WhileMappingTheCovarianceToTheFirstStopIsLeftOut) {
  LivePose pose;
  pose.covariance = Eigen::Matrix3d::Identity();
  pose.mode = msg::kModeLocalization;
  EXPECT_EQ(to_pose_fix(pose).covariance, pose.covariance);
  pose.mode = msg::kModeMapping;
  EXPECT_TRUE(to_pose_fix(pose).covariance.isZero());
}

// Standard deviations of 0.1 m and 0.05 rad: within 0.3 m in 98.9 %, within 5 degrees in 91.9 %.
TEST(NavigationConversions, APoseOfMarkovLocalizationIsOneToPlanBy) {
  navigation::PoseFix fix;
  fix.stamp_ns = 7;
  fix.T_map_robot = {1.0, 2.0, 0.5};
  fix.covariance = Eigen::Vector3d(0.01, 0.01, 0.0025).asDiagonal();
  fix.tracking = true;
  const LivePose pose = from_msg(to_msg(to_live_pose(fix, 3), "robot"));
  EXPECT_EQ(pose.mode, msg::kModeMarkov);
  EXPECT_EQ(pose.stamp_ns, 7);
  EXPECT_EQ(pose.sequence, 3U);
  EXPECT_EQ(pose.T_map_robot, fix.T_map_robot);
  EXPECT_EQ(to_pose_fix(pose).covariance, fix.covariance);
  EXPECT_TRUE(localization::located(pose.status.state));
  EXPECT_NEAR(pose.status.confidence, 0.98889 * 0.91909, 1e-4);
  fix.tracking = false;
  EXPECT_FALSE(localization::located(to_live_pose(fix, 4).status.state));
  EXPECT_EQ(to_live_pose(fix, 4).status.confidence, 0.0);
}

}  // namespace
}  // namespace topogeo::service
