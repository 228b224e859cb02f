#include "topogeo/navigation/path_follower.hpp"

#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::navigation {
namespace {

/// A base that obeys late, exactly, and without limits.
class Base {
 public:
  explicit Base(const geometry::Pose2& pose) : T_map_robot(pose) {}

  FollowerStep step(PathFollower& follower, double limit_m_per_s = 10.0) {
    const FollowerStep order = follower.step(T_map_robot, now_ns, limit_m_per_s);
    follower.commanded(order.command, now_ns);
    delayed_.push_back(order.command);
    const geometry::Velocity obeyed = delayed_.front();
    delayed_.pop_front();
    constexpr double kStep_s = 0.05;
    for (int i = 0; i < 10; ++i) {
      const double step_m = obeyed.linear_m_per_s * kStep_s / 10.0;
      T_map_robot =
          T_map_robot * geometry::Pose2{step_m, 0.0, obeyed.angular_rad_per_s * kStep_s / 10.0};
    }
    largest_acceleration = std::max(
        largest_acceleration, (order.command.linear_m_per_s - last_.linear_m_per_s) / kStep_s);
    largest_turn = std::max(largest_turn, std::fabs(order.command.angular_rad_per_s));
    least_speed = std::min(least_speed, order.command.linear_m_per_s);
    largest_off_m = std::max(largest_off_m, order.off_m);
    last_ = order.command;
    now_ns += 50'000'000;
    return order;
  }

  bool follow(PathFollower& follower, double longest_s) {
    for (int i = 0; i < static_cast<int>(longest_s * 20.0); ++i) {
      if (step(follower).done) return true;
    }
    return false;
  }

  geometry::Pose2 T_map_robot;
  std::int64_t now_ns = 0;
  double largest_acceleration = 0.0;
  double largest_turn = 0.0;
  double least_speed = 0.0;
  double largest_off_m = 0.0;

 private:
  std::deque<geometry::Velocity> delayed_ = std::deque<geometry::Velocity>(2);
  geometry::Velocity last_;
};

const std::array<Eigen::Vector2d, 3> kCorner = {
    Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(3.0, 0.0), Eigen::Vector2d(3.0, 2.0)};

TEST(PathFollower, StopsAtTheEndInTheHeadingWithinItsLimits) {
  const FollowerConfig config;
  PathFollower follower(config);
  follower.follow(straight_path(kCorner), -0.5);
  Base base({0.0, 0.0, 0.3});
  ASSERT_TRUE(base.follow(follower, 40.0));
  EXPECT_NEAR(base.T_map_robot.x_m, 3.0, config.arrival_m);
  EXPECT_NEAR(base.T_map_robot.y_m, 2.0, config.arrival_m);
  EXPECT_NEAR(base.T_map_robot.theta_rad, -0.5, config.arrival_rad);
  EXPECT_LE(base.largest_acceleration, config.acceleration_m_per_s2 + 1e-9);
  EXPECT_LE(base.largest_turn, config.turn_rad_per_s + 1e-9);
  EXPECT_GE(base.least_speed, 0.0);  // never backwards
}

TEST(PathFollower, ReportsPrimitivesAsTheyAreFinished) {
  PathFollower follower{FollowerConfig{}};
  follower.follow(straight_path(kCorner), std::nullopt);
  Base base({0.0, 0.0, 0.0});
  ASSERT_TRUE(base.follow(follower, 40.0));
  const auto finished = follower.take_finished();
  ASSERT_EQ(finished.size(), 3U);
  EXPECT_EQ(finished[0].kind, planning::MotionKind::kAdvance);
  EXPECT_NEAR(finished[0].amount, 3.0, 0.03);
  EXPECT_EQ(finished[1].kind, planning::MotionKind::kTurnLeft);
  EXPECT_NEAR(finished[1].amount, 0.5 * std::numbers::pi, 0.08);
  EXPECT_EQ(finished[2].kind, planning::MotionKind::kAdvance);
  EXPECT_NEAR(finished[2].amount, 2.0, 0.03);
  EXPECT_TRUE(follower.take_finished().empty());
}

TEST(PathFollower, PrimitivesThatNobodyAsksForDoNotPileUp) {
  PathFollower follower{FollowerConfig{}};
  Base base({0.0, 0.0, 0.0});
  for (const double heading_rad : {0.5, 1.0, 1.5}) {
    follower.follow({}, heading_rad);
    ASSERT_TRUE(base.follow(follower, 20.0));
  }
  const auto finished = follower.take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_NEAR(finished[0].amount, 0.5, 0.03);
}

TEST(PathFollower, ComesBackToThePathFromBesideIt) {
  PathFollower follower{FollowerConfig{}};
  const std::array<Eigen::Vector2d, 2> line = {Eigen::Vector2d(0.0, 0.0),
                                               Eigen::Vector2d(4.0, 0.0)};
  follower.follow(straight_path(line), std::nullopt);
  Base base({0.0, 0.2, 0.0});
  while (base.T_map_robot.x_m < 2.0 && base.now_ns < 20'000'000'000) base.step(follower);
  EXPECT_NEAR(base.T_map_robot.y_m, 0.0, 0.02);
  EXPECT_NEAR(base.T_map_robot.theta_rad, 0.0, 0.05);
}

TEST(PathFollower, TurnsOnTheSpotWhenItLooksElsewhere) {
  PathFollower follower{FollowerConfig{}};
  const std::array<Eigen::Vector2d, 2> line = {Eigen::Vector2d(0.0, 0.0),
                                               Eigen::Vector2d(2.0, 0.0)};
  follower.follow(straight_path(line), std::nullopt);
  Base base({0.0, 0.0, 3.0});
  while (std::fabs(base.T_map_robot.theta_rad) > 0.3 && base.now_ns < 10'000'000'000) {
    EXPECT_EQ(base.step(follower).command.linear_m_per_s, 0.0);
  }
  EXPECT_NEAR(base.T_map_robot.position_m().norm(), 0.0, 1e-6);
  ASSERT_TRUE(base.follow(follower, 20.0));
  EXPECT_LT(base.largest_off_m, 0.05);
}

TEST(PathFollower, KeepsToTheSpeedLimit) {
  PathFollower follower{FollowerConfig{}};
  const std::array<Eigen::Vector2d, 2> line = {Eigen::Vector2d(0.0, 0.0),
                                               Eigen::Vector2d(9.0, 0.0)};
  follower.follow(straight_path(line), std::nullopt);
  Base base({0.0, 0.0, 0.0});
  for (int i = 0; i < 100; ++i) {
    EXPECT_LE(base.step(follower, 0.2).command.linear_m_per_s, 0.2 + 1e-9);
  }
  for (int i = 0; i < 20; ++i) base.step(follower, 0.0);
  EXPECT_EQ(base.step(follower, 0.0).command.linear_m_per_s, 0.0);
}

TEST(PathFollower, FinalHeadingAlone) {
  PathFollower follower{FollowerConfig{}};
  follower.follow({}, 1.0);
  Base base({0.0, 0.0, -2.5});
  ASSERT_TRUE(base.follow(follower, 20.0));
  EXPECT_NEAR(base.T_map_robot.theta_rad, 1.0, FollowerConfig{}.arrival_rad);
}

TEST(PathFollower, SettingsOutOfRangeAreRefused) {
  FollowerConfig config;
  config.speed_m_per_s = 0.0;
  EXPECT_THROW(PathFollower{config}, std::invalid_argument);
  config = {};
  config.arrival_rad = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(PathFollower{config}, std::invalid_argument);
}

TEST(PathFollower, ReversesALegAndGoesOn) {
  // Back for a metre, then ahead to the left.
  std::vector<planning::PathSample> path;
  path.reserve(21);
  for (int i = 0; i < 10; ++i) {
    path.push_back({{-0.1 * i, 0.0, std::numbers::pi}, 0.1 * i, 0.0, 0.0, true});
  }
  for (int i = 0; i <= 10; ++i) {
    const double turn_rad = i == 0 ? 0.5 * std::numbers::pi : 0.0;
    path.push_back({{-1.0, 0.1 * i, 0.5 * std::numbers::pi}, 1.0 + 0.1 * i, 0.0, turn_rad});
  }
  PathFollower follower{FollowerConfig{}};
  follower.follow(path, 0.5 * std::numbers::pi);
  Base base({0.0, 0.02, 0.03});
  ASSERT_TRUE(base.follow(follower, 30.0));
  EXPECT_NEAR(base.T_map_robot.x_m, -1.0, 0.03);
  EXPECT_NEAR(base.T_map_robot.y_m, 1.0, 0.03);
  EXPECT_NEAR(base.T_map_robot.theta_rad, 0.5 * std::numbers::pi, 0.03);
  EXPECT_LT(base.least_speed, -0.2);
  EXPECT_LT(base.largest_off_m, 0.05);
}

}  // namespace
}  // namespace topogeo::navigation
