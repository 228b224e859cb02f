#include "topogeo/simulation/odometry.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

constexpr OdometryDrift kPerfectWheels{.range_scale_error = 0.0,
                                       .range_sigma_m_per_sqrt_m = 0.0,
                                       .heading_drift_rad_per_m = 0.0,
                                       .heading_sigma_rad_per_sqrt_m = 0.0,
                                       .turn_sigma_rad_per_sqrt_rad = 0.0};

TEST(Odometry, WithoutDriftItIsTheTruthSeenFromTheStart) {
  OdometryModel model(kPerfectWheels, support::Random(1));
  const geometry::Pose2 start{5.0, -3.0, 2.0};
  EXPECT_EQ(model.advance(start), geometry::Pose2());
  for (int i = 1; i < 200; ++i) {
    const double t = 0.05 * i;
    const geometry::Pose2 truth{5.0 + 2.0 * t, -3.0 + std::sin(t), geometry::wrap_angle(2.0 + t)};
    const geometry::Pose2 odometry = model.advance(truth);
    const geometry::Pose2 expected = geometry::between(start, truth);
    ASSERT_NEAR(odometry.x_m, expected.x_m, 1e-9);
    ASSERT_NEAR(odometry.y_m, expected.y_m, 1e-9);
    ASSERT_NEAR(geometry::wrap_angle(odometry.theta_rad - expected.theta_rad), 0.0, 1e-9);
  }
}

TEST(Odometry, SystematicErrorsFollowThePath) {
  OdometryDrift drift = kPerfectWheels;
  drift.range_scale_error = 0.02;
  OdometryModel scaled(drift, support::Random(1));
  scaled.advance({});
  EXPECT_NEAR(scaled.advance({10.0, 0.0, 0.0}).x_m, 10.2, 1e-12);

  drift = kPerfectWheels;
  drift.heading_drift_rad_per_m = 0.01;
  OdometryModel bent(drift, support::Random(1));
  geometry::Pose2 odometry;
  for (int i = 0; i <= 100; ++i) odometry = bent.advance({0.1 * i, 0.0, 0.0});
  EXPECT_NEAR(odometry.theta_rad, 0.1, 1e-9);
  // An arc of radius 100 m.
  EXPECT_NEAR(odometry.y_m, 100.0 * (1.0 - std::cos(0.1)), 0.01);
}

// The random walk must not depend on how often odometry is read.
TEST(Odometry, RandomHeadingGrowsWithTheRootOfThePath) {
  OdometryDrift drift = kPerfectWheels;
  drift.heading_sigma_rad_per_sqrt_m = 0.01;
  for (const int steps : {4, 64}) {
    double sum2 = 0.0;
    constexpr int kRuns = 2000;
    for (int run = 0; run < kRuns; ++run) {
      OdometryModel model(drift, support::Random(static_cast<std::uint64_t>(run)));
      geometry::Pose2 odometry = model.advance({});
      for (int i = 1; i <= steps; ++i) odometry = model.advance({16.0 * i / steps, 0.0, 0.0});
      sum2 += odometry.theta_rad * odometry.theta_rad;
    }
    EXPECT_NEAR(std::sqrt(sum2 / kRuns), 0.04, 0.003) << steps;
  }
}

TEST(Odometry, TurningOnTheSpotErrsInHeadingOnly) {
  OdometryDrift drift = kPerfectWheels;
  drift.turn_sigma_rad_per_sqrt_rad = 0.02;
  OdometryModel model(drift, support::Random(9));
  model.advance({});
  const geometry::Pose2 odometry = model.advance({0.0, 0.0, 1.0});
  EXPECT_EQ(odometry.x_m, 0.0);
  EXPECT_EQ(odometry.y_m, 0.0);
  EXPECT_NE(odometry.theta_rad, 1.0);
  EXPECT_NEAR(odometry.theta_rad, 1.0, 0.1);
}

TEST(Odometry, ATurnScaleIsTakenOfTheTurnWithItsSign) {
  OdometryDrift drift = kPerfectWheels;
  drift.turn_scale_error = 0.1;
  OdometryModel model(drift, support::Random(1));
  model.advance({});
  EXPECT_NEAR(model.advance({0.0, 0.0, 1.0}).theta_rad, 1.1, 1e-12);
  EXPECT_NEAR(model.advance({0.0, 0.0, -1.0}).theta_rad, 1.1 - 2.2, 1e-12);
}

TEST(Odometry, SlipsGrowWithTheRootOfWayAndTurn) {
  OdometryDrift drift = kPerfectWheels;
  drift.lateral_sigma_m_per_sqrt_m = 0.03;
  drift.turn_shift_sigma_m_per_sqrt_rad = 0.02;
  double across2 = 0.0;
  double shift2 = 0.0;
  constexpr int kRuns = 2000;
  for (int run = 0; run < kRuns; ++run) {
    OdometryModel model(drift, support::Random(static_cast<std::uint64_t>(run)));
    model.advance({});
    const geometry::Pose2 driven = model.advance({4.0, 0.0, 0.0});
    EXPECT_EQ(driven.x_m, 4.0);
    across2 += driven.y_m * driven.y_m;
    const geometry::Pose2 turned = model.advance({4.0, 0.0, 1.0});
    shift2 += (turned.x_m - driven.x_m) * (turned.x_m - driven.x_m);
  }
  EXPECT_NEAR(std::sqrt(across2 / kRuns), 0.06, 0.004);
  EXPECT_NEAR(std::sqrt(shift2 / kRuns), 0.02, 0.0015);
}

TEST(Odometry, DoesNotNoticeThatItIsCarried) {
  OdometryModel model(kPerfectWheels, support::Random(1));
  model.advance({});
  model.advance({1.0, 0.0, 0.0});
  model.carry({50.0, 20.0, 1.0});
  const geometry::Pose2 odometry = model.advance({50.0, 20.0, 1.0});
  EXPECT_NEAR(odometry.x_m, 1.0, 1e-12);
  EXPECT_NEAR(odometry.y_m, 0.0, 1e-12);
  EXPECT_NEAR(odometry.theta_rad, 0.0, 1e-12);
}

}  // namespace
}  // namespace topogeo::simulation
