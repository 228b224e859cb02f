// One step by itself: the priority of the reasons not to move, and that no motion bypasses the
// guard. navigator_*_test.cpp has whole drives.
#include "navigation_step.hpp"

#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kStepTime_ns = 1'000'000'000;

/// In the middle of the lower half of the room of 8 x 6 m, facing x.
const geometry::Pose2 kPose{4.0, 2.0, 0.0};

class NavigationStepTest : public testing::Test {
 protected:
  static NavigatorConfig settings() { return {}; }

  /// The step's reason not to drive; it must not move.
  HaltReason halts() {
    EXPECT_EQ(step_.step(kStepTime_ns), geometry::Velocity{});
    return step_.status.reason;
  }
  void give_goal() {
    step_.goal.set({7});
    step_.routes.expect(kStepTime_ns);
  }
  void give_odometry() {
    const OdometrySample sample{kStepTime_ns, {}};
    step_.poses.add(sample);
    step_.base.add(sample);
  }
  void give_pose(const geometry::Pose2& T_map_robot) {
    PoseFix fix;
    fix.stamp_ns = kStepTime_ns;
    fix.T_map_robot = T_map_robot;
    fix.covariance = Eigen::Matrix3d::Identity() * 1e-6;
    fix.tracking = fix.located = true;
    step_.poses.add(fix);
  }
  /// A scan with nothing within 2 m.
  void give_scan() {
    ScanPoints scan;
    scan.stamp_ns = kStepTime_ns;
    scan.points_m = {{2.0, -2.0}, {2.0, 0.0}, {2.0, 2.0}};
    step_.base.add(scan);
    step_.poses.add(scan);
    step_.surroundings.add(scan);
  }
  void give_map() { step_.routes.set_map(map_of(room()), 1); }

  NavigationStep step_{settings()};
};

TEST_F(NavigationStepTest, WithoutAGoalItIsIdle) {
  EXPECT_EQ(halts(), HaltReason::kNone);
  EXPECT_EQ(step_.status.state, NavigatorState::kIdle);
}

TEST_F(NavigationStepTest, APauseComesBeforeEverythingElse) {
  give_goal();
  step_.goal.pause();
  EXPECT_EQ(halts(), HaltReason::kPaused);
}

TEST_F(NavigationStepTest, NamesTheFirstInputThatIsMissing) {
  give_goal();
  EXPECT_EQ(halts(), HaltReason::kNoOdometry);
  give_odometry();
  EXPECT_EQ(halts(), HaltReason::kNoScan);
  give_scan();
  EXPECT_EQ(halts(), HaltReason::kPoseLost);
  EXPECT_EQ(step_.status.state, NavigatorState::kRelocalizing);
  give_pose(kPose);
  EXPECT_EQ(halts(), HaltReason::kNoMap);
  give_map();
  EXPECT_EQ(halts(), HaltReason::kWaitsForRoute);
}

TEST_F(NavigationStepTest, APoseOffTheMapIsNamed) {
  give_goal();
  give_odometry();
  give_scan();
  give_map();
  give_pose({400.0, 2.0, 0.0});
  EXPECT_EQ(halts(), HaltReason::kOutsideMap);
}

TEST_F(NavigationStepTest, DrivesOnceItHasARoute) {
  give_goal();
  give_odometry();
  give_scan();
  give_pose(kPose);
  give_map();
  RoutePlan route;
  route.goal_id = 7;
  route.map_version = 1;
  route.found = true;
  route.points_m = {kPose.position_m(), {6.0, 2.0}};
  step_.routes.offer(route);
  EXPECT_GT(step_.step(kStepTime_ns).linear_m_per_s, 0.0) << step_.status.message;
  EXPECT_EQ(step_.status.state, NavigatorState::kDriving);
}

TEST_F(NavigationStepTest, SettingsOutOfRangeAreRefused) {
  NavigatorConfig config = settings();
  config.oldest_odometry_s = -1.0;
  EXPECT_THROW(NavigationStep{config}, std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::navigation
