#include "topogeo/navigation/arc_sweep.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

TEST(ArcSweep, StraightToAPoint) {
  const std::vector<Eigen::Vector2d> points_m = {{2.0, 0.3}, {1.5, 0.6}};
  const SweptArc arc = sweep({0.5, 0.0}, points_m, 0.5, 5.0);
  EXPECT_NEAR(arc.length_m, 2.0 - 0.4, 1e-12);
  EXPECT_EQ(arc.contact, 0U);
  EXPECT_NEAR(sweep({0.5, 0.0}, points_m, 0.5, 1.0).length_m, 1.0, 1e-12);
  EXPECT_NEAR(sweep({-0.5, 0.0}, points_m, 0.5, 5.0).length_m, 5.0, 1e-12);
}

TEST(ArcSweep, AQuarterCircle) {
  // A point on the circle of 1 m to the left, a quarter round; the disc of 0.1 m meets it earlier.
  const std::vector<Eigen::Vector2d> points_m = {{1.0, 1.0}};
  const double before_rad = 2.0 * std::asin(0.05);
  EXPECT_NEAR(sweep({1.0, 1.0}, points_m, 0.1, 5.0).length_m, 0.5 * std::numbers::pi - before_rad,
              1e-9);
  EXPECT_NEAR(sweep({1.0, -1.0}, points_m, 0.1, 5.0).length_m, 5.0, 1e-9);
}

TEST(ArcSweep, AgreesWithFineSteps) {
  support::Random random(3);
  int met = 0;
  for (int run = 0; run < 500; ++run) {
    const geometry::Velocity motion{random.uniform(-1.0, 1.0), random.uniform(-3.0, 3.0)};
    const double radius_m = random.uniform(0.05, 0.5);
    const Eigen::Vector2d point_m(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    if (point_m.norm() < radius_m || std::fabs(motion.linear_m_per_s) < 0.05) continue;
    const std::vector<Eigen::Vector2d> points_m = {point_m};
    constexpr double kLimit_m = 2.0;
    const double length_m = sweep(motion, points_m, radius_m, kLimit_m).length_m;
    double stepped_m = 0.0;
    constexpr double kPiece_m = 0.0005;
    for (; stepped_m < kLimit_m; stepped_m += kPiece_m) {
      const auto pose = moved(motion, stepped_m / std::fabs(motion.linear_m_per_s));
      if ((pose.position_m() - point_m).norm() < radius_m) break;
    }
    if (stepped_m < kLimit_m) ++met;
    // The steps may miss a point that is only touched.
    if (stepped_m < kLimit_m) {
      EXPECT_NEAR(length_m, stepped_m, 0.002) << "run " << run;
    }
  }
  EXPECT_GT(met, 20);
}

TEST(StoppingSpeed, UsesUpTheDistance) {
  EXPECT_EQ(stopping_speed(0.0, 0.3, 0.5), 0.0);
  EXPECT_EQ(stopping_speed(-1.0, 0.3, 0.5), 0.0);
  EXPECT_DOUBLE_EQ(stopping_speed(1.0, 0.0, 0.5), 1.0);
  const double speed = stopping_speed(1.0, 0.3, 0.5);
  EXPECT_NEAR(speed * 0.3 + speed * speed, 1.0, 1e-12);
}

}  // namespace
}  // namespace topogeo::navigation
