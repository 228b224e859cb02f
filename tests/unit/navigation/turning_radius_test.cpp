// A base with a smallest turning radius: no part of the navigator commands a tighter turn.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/last_guard.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/path_follower.hpp"

#include "arrival.hpp"
#include "look_around.hpp"
#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kRadius_m = 0.8;
const geometry::Footprint kRectangle{{{0.6, 0.3}, {0.6, -0.3}, {-0.6, -0.3}, {-0.6, 0.3}}};

GuardConfig steered(const geometry::Footprint& footprint = {}) {
  GuardConfig config;
  config.footprint = footprint;
  config.minimum_turning_radius_m = kRadius_m;
  return config;
}

bool drivable(const geometry::Velocity& velocity) {
  return std::fabs(velocity.angular_rad_per_s) * kRadius_m <=
         std::fabs(velocity.linear_m_per_s) + 1e-9;
}

TEST(Drivable, KeepsTheSpeedAndLimitsTheTurn) {
  EXPECT_EQ(geometry::drivable({0.4, 1.0}, 0.8), (geometry::Velocity{0.4, 0.5}));
  EXPECT_EQ(geometry::drivable({-0.4, -1.0}, 0.8), (geometry::Velocity{-0.4, -0.5}));
  EXPECT_EQ(geometry::drivable({0.4, 0.3}, 0.8), (geometry::Velocity{0.4, 0.3}));
  EXPECT_EQ(geometry::drivable({0.0, 0.3}, 0.8), geometry::Velocity{});
  EXPECT_EQ(geometry::drivable({0.0, 0.3}, 0.0), (geometry::Velocity{0.0, 0.3}));
}

TEST(TurningRadius, TheGuardRefusesATurnOnTheSpotWithAReason) {
  for (const auto& footprint : {geometry::Footprint{}, kRectangle}) {
    CollisionGuard guard(steered(footprint));
    guard.add(OdometrySample{kSecond_ns, {}});
    guard.add(scan_of_post(5.0, kSecond_ns));
    const GuardVerdict turn = guard.judge({0.0, 0.5}, kSecond_ns);
    EXPECT_EQ(turn.allowed, geometry::Velocity{});
    EXPECT_EQ(turn.reason, HaltReason::kBaseNotReady);
    EXPECT_THAT(turn.message, testing::HasSubstr("smallest turning radius is 0.80 m"));
    const GuardVerdict tight = guard.judge({0.2, 1.0}, kSecond_ns);
    EXPECT_EQ(tight.allowed, (geometry::Velocity{0.2, 0.25}));
    EXPECT_TRUE(tight.limited);
    EXPECT_EQ(guard.judge({0.0, 0.0}, kSecond_ns).reason, HaltReason::kNone);
  }
}

TEST(TurningRadius, TheGuardSweepsTheArcThatIsDriven) {
  // The arc of the base leads into a point at its front.
  CollisionGuard guard(steered(kRectangle));
  guard.add(OdometrySample{kSecond_ns, {}});
  ScanPoints scan;
  scan.stamp_ns = kSecond_ns;
  scan.points_m = {{0.63, 0.2}};
  guard.add(scan);
  EXPECT_EQ(guard.judge({0.2, 2.0}, kSecond_ns).allowed, geometry::Velocity{});
}

TEST(TurningRadius, TheLastGuardPassesNoTighterTurn) {
  for (const auto& footprint : {geometry::Footprint{}, kRectangle}) {
    LastGuard guard(steered(footprint), 0.0);
    geometry::OdometrySample odometry;
    odometry.stamp_ns = kSecond_ns;
    guard.add(odometry);
    guard.add(scan_of_post(5.0, kSecond_ns));
    EXPECT_EQ(guard.judge({0.0, 0.5}, 0.5, kSecond_ns).allowed, geometry::Velocity{});
    EXPECT_EQ(guard.judge({0.2, 1.0}, 0.5, kSecond_ns).allowed, (geometry::Velocity{0.2, 0.25}));
    EXPECT_EQ(guard.judge({0.2, 0.1}, 0.5, kSecond_ns).allowed, (geometry::Velocity{0.2, 0.1}));
  }
}

/// Arcs and lines as samples; a length below 0 goes back.
std::vector<planning::PathSample> path_of(
    const std::vector<std::pair<double, double>>& lengths_and_curvatures) {
  std::vector<planning::PathSample> samples;
  geometry::Pose2 pose;
  double distance_m = 0.0;
  const auto push = [&](bool back, double curvature_per_m) {
    planning::PathSample sample;
    sample.T_map_robot = pose;
    if (back) {
      sample.T_map_robot.theta_rad = geometry::wrap_angle(pose.theta_rad + std::numbers::pi);
    }
    sample.distance_m = distance_m;
    sample.curvature_per_m = back ? -curvature_per_m : curvature_per_m;
    sample.backward = back;
    samples.push_back(sample);
  };
  for (const auto& [length_m, curvature_per_m] : lengths_and_curvatures) {
    constexpr int kSteps = 16;
    for (int k = 0; k < kSteps; ++k) {
      push(length_m < 0.0, curvature_per_m);
      pose = pose * moved({length_m / kSteps, curvature_per_m * length_m / kSteps}, 1.0);
      distance_m += std::fabs(length_m) / kSteps;
    }
  }
  push(lengths_and_curvatures.back().first < 0.0, 0.0);
  return samples;
}

/// The pose at the end of a path of samples.
geometry::Pose2 end_of(const std::vector<planning::PathSample>& path) {
  geometry::Pose2 pose = path.back().T_map_robot;
  if (path.back().backward)
    pose.theta_rad = geometry::wrap_angle(pose.theta_rad + std::numbers::pi);
  return pose;
}

class Steered : public testing::Test {
 protected:
  Steered() {
    config.minimum_radius_m = kRadius_m;
    config.delay_s = 0.0;
  }

  /// Follows until it is done; every command must be drivable.
  void follow(const std::vector<planning::PathSample>& path, geometry::Pose2 start) {
    PathFollower follower(config);
    follower.follow(path, end_of(path).theta_rad);
    pose = start;
    constexpr double kStep_s = 0.05;
    for (int i = 0; i < 2000 && !done; ++i) {
      const FollowerStep step = follower.step(pose, now_ns, 10.0);
      follower.commanded(step.command, now_ns);
      EXPECT_TRUE(drivable(step.command))
          << step.command.linear_m_per_s << " m/s, " << step.command.angular_rad_per_s << " rad/s";
      pose = pose * moved(step.command, kStep_s);
      now_ns += 50'000'000;
      done = step.done;
      strayed = strayed || step.strayed;
      if (strayed) return;
    }
  }

  FollowerConfig config;
  geometry::Pose2 pose;
  std::int64_t now_ns = 0;
  bool done = false;
  bool strayed = false;
};

TEST_F(Steered, FollowsBendsAndReversalsToTheirEnd) {
  constexpr double kBend = 1.0 / (1.1 * kRadius_m);
  const auto path =
      path_of({{1.5, 0.0}, {1.2, kBend}, {1.2, -kBend}, {-1.0, kBend}, {0.8, -kBend}, {1.0, 0.0}});
  for (const geometry::Pose2& start : {geometry::Pose2{}, geometry::Pose2{0.0, 0.05, -0.05}}) {
    done = false;
    follow(path, start);
    ASSERT_TRUE(done);
    const geometry::Pose2 end = end_of(path);
    EXPECT_LT((pose.position_m() - end.position_m()).norm(), 0.04);
    EXPECT_LT(std::fabs(geometry::wrap_angle(pose.theta_rad - end.theta_rad)), 0.05);
  }
}

TEST_F(Steered, ReportsThatItDoesNotGetBackToThePath) {
  follow(path_of({{2.0, 0.0}}), {0.0, 0.0, 2.0});
  EXPECT_TRUE(strayed);
  EXPECT_EQ(pose, (geometry::Pose2{0.0, 0.0, 2.0}));
}

TEST_F(Steered, StandsWhereOnlyAHeadingIsWanted) {
  PathFollower follower(config);
  follower.follow({}, 1.5);
  for (std::int64_t i = 0; i < 20; ++i) {
    EXPECT_EQ(follower.step({}, i * 50'000'000, 10.0).command, geometry::Velocity{});
    follower.commanded({}, i * 50'000'000);
  }
  EXPECT_TRUE(follower.step({}, kSecond_ns, 10.0).done);
}

TEST(TurningRadius, LooksAroundOnArcsAheadAndBack) {
  // A wall 0.9 m ahead: no room for a circle, and sonars for the way back.
  constexpr double kWall_m = 0.9;
  CollisionGuard guard(steered());
  LookAround look(8.0, kRadius_m);
  geometry::Pose2 pose;
  std::int64_t now_ns = kSecond_ns;
  double turned_rad = 0.0;
  bool ahead = false;
  bool back = false;
  for (int i = 0; i < 4000 && !look.been_round(); ++i) {
    ScanPoints scan;
    scan.stamp_ns = now_ns;
    scan.T_odom_robot = pose;
    for (double y_m = -4.0; y_m <= 4.0; y_m += 0.05) {
      scan.points_m.push_back(geometry::inverse(pose) * Eigen::Vector2d(kWall_m, y_m));
    }
    guard.add(OdometrySample{now_ns, pose});
    guard.add(scan);
    SonarRound sonar;
    sonar.stamp_ns = now_ns;
    guard.add(sonar);
    const geometry::Velocity wanted = look.step(pose, guard, now_ns);
    EXPECT_TRUE(drivable(wanted));
    EXPECT_GE(wanted.angular_rad_per_s, 0.0);
    const geometry::Velocity allowed = guard.judge(wanted, now_ns).allowed;
    ahead = ahead || allowed.linear_m_per_s > 0.0;
    back = back || allowed.linear_m_per_s < 0.0;
    turned_rad += allowed.angular_rad_per_s * 0.05;
    pose = pose * moved(allowed, 0.05);
    ASSERT_LT(pose.x_m, kWall_m - 0.267) << "touches the wall";
    now_ns += 50'000'000;
  }
  EXPECT_TRUE(ahead);
  EXPECT_TRUE(back);
  EXPECT_NEAR(turned_rad, 2.0 * std::numbers::pi, 0.1);
  EXPECT_GT(look.gone_m(), 1.0);
}

TEST(TurningRadius, LooksNowhereWithoutRoom) {
  CollisionGuard guard(steered());
  guard.add(OdometrySample{kSecond_ns, {}});
  guard.add(scan_of_post(0.35, kSecond_ns));  // and no sonars for the way back
  LookAround look(5.0, kRadius_m);
  EXPECT_EQ(look.step({}, guard, kSecond_ns), geometry::Velocity{});
  EXPECT_TRUE(look.finished());
}

TEST(TurningRadius, ArrivesWithoutAManoeuvreForCentimetres) {
  NavigatorConfig config;
  config.guard = steered();
  Arrival arrival(config);
  ArrivalView view;
  view.goal_m = {0.04, 0.0};
  view.heading_rad = 0.05;
  view.tracking = false;  // and no turn to look around
  const auto settled = [&] {
    arrival.begin(0);
    view.fix_ns = kSecond_ns;
    return arrival.step(view, kSecond_ns).kind;
  };
  EXPECT_EQ(settled(), ArrivalStep::Kind::kArrived);
  view.heading_rad = 0.3;
  arrival.reset();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(settled(), ArrivalStep::Kind::kMoves);
  EXPECT_EQ(settled(), ArrivalStep::Kind::kArrived);
}

TEST(TurningRadius, PrimitivesTurnOnTheSpot) {
  NavigatorConfig config;
  config.guard = steered();
  EXPECT_NO_THROW(check(config));
  config.motion = MotionStyle::kPrimitives;
  EXPECT_THROW(check(config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::navigation
