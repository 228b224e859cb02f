#include "topogeo/navigation/outline_sweep.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/last_guard.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kNow_ns = 5'000'000'000;
const geometry::Footprint kRectangle{{{0.6, 0.3}, {0.6, -0.3}, {-0.6, -0.3}, {-0.6, 0.3}}};

TEST(OutlineSweep, StraightAheadAndBack) {
  const std::vector<Eigen::Vector2d> points_m = {{1.5, 0.29}, {-1.0, 0.0}, {1.0, 0.35}};
  const OutlineSweep ahead = sweep({0.5, 0.0}, points_m, kRectangle, 0.0, 5.0);
  EXPECT_NEAR(ahead.length_m, 0.9, 0.01);
  EXPECT_EQ(ahead.contact, 0U);
  EXPECT_NEAR(sweep({-0.5, 0.0}, points_m, kRectangle, 0.0, 5.0).length_m, 0.4, 0.01);
}

TEST(OutlineSweep, ATurnOnTheSpotEndsWhereACornerTouches) {
  // Beside the body, within the circle of its corners.
  const std::vector<Eigen::Vector2d> points_m = {{0.0, 0.5}};
  const OutlineSweep left = sweep({0.0, 0.5}, points_m, kRectangle, 0.0, 5.0);
  // The right edge of the front comes there at the angle where 0.5 cos a = 0.3 on the side.
  const double angle_rad = std::acos(0.3 / 0.5);
  EXPECT_NEAR(left.reach_m, angle_rad * geometry::circumscribed_radius_m(kRectangle), 0.02);
  EXPECT_EQ(left.length_m, 0.0);
  EXPECT_EQ(
      sweep({0.0, 0.5}, std::vector<Eigen::Vector2d>{{0.0, 0.7}}, kRectangle, 0.0, 5.0).contact,
      std::nullopt);
}

TEST(OutlineSweep, AgreesWithFineSteps) {
  support::Random random(3);
  int met = 0;
  for (int run = 0; run < 400; ++run) {
    const geometry::Velocity motion{random.uniform(-1.0, 1.0), random.uniform(-2.0, 2.0)};
    const Eigen::Vector2d point_m(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
    if (geometry::signed_distance_m(kRectangle, point_m) < 0.05) continue;
    const std::vector<Eigen::Vector2d> points_m = {point_m};
    const double speed = outline_speed(motion, kRectangle);
    constexpr double kLimit_m = 2.5;
    const OutlineSweep swept = sweep(motion, points_m, kRectangle, 0.02, kLimit_m);
    double reach_m = 0.0;
    for (; reach_m < kLimit_m; reach_m += 0.001) {
      const auto T_then_now = geometry::inverse(moved(motion, reach_m / speed));
      if (geometry::signed_distance_m(kRectangle, T_then_now * point_m) < 0.02) break;
    }
    if (reach_m >= kLimit_m) continue;
    ++met;
    // It may pass a point by less than its step.
    if (!swept.contact) continue;
    EXPECT_NEAR(swept.reach_m, reach_m, 0.01) << "run " << run;
  }
  EXPECT_GT(met, 15);
}

TEST(OutlineSweep, LeavesWhatItTouches) {
  const std::vector<Eigen::Vector2d> points_m = {{0.605, 0.0}};
  EXPECT_EQ(sweep({0.3, 0.0}, points_m, kRectangle, 0.02, 1.0).reach_m, 0.0);
  EXPECT_EQ(sweep({-0.3, 0.0}, points_m, kRectangle, 0.02, 1.0).reach_m, 1.0);
}

GuardConfig rectangular() {
  GuardConfig config;
  config.footprint = kRectangle;
  return config;
}

ScanPoints scan_of(const std::vector<Eigen::Vector2d>& points_m) {
  ScanPoints scan;
  scan.stamp_ns = kNow_ns;
  scan.points_m = points_m;
  return scan;
}

CollisionGuard guard_seeing(const std::vector<Eigen::Vector2d>& points_m) {
  CollisionGuard guard(rectangular());
  guard.add(OdometrySample{kNow_ns, {}});
  guard.add(scan_of(points_m));
  return guard;
}

TEST(OutlineGuard, RefusesATurnWithoutRoom) {
  const auto free = guard_seeing({{0.0, 0.9}}).judge({0.0, 0.5}, kNow_ns);
  EXPECT_EQ(free.allowed, (geometry::Velocity{0.0, 0.5}));
  // A post beside the front corner.
  const auto near = guard_seeing({{0.58, 0.34}}).judge({0.0, 0.5}, kNow_ns);
  EXPECT_EQ(near.allowed, geometry::Velocity{});
  EXPECT_EQ(near.reason, HaltReason::kObstacle);
  EXPECT_EQ(near.message, "no room to turn on the spot");
  // Away from it the front is free, and the back has room.
  const auto away = guard_seeing({{0.58, 0.34}}).judge({0.0, -0.5}, kNow_ns);
  EXPECT_LT(away.allowed.angular_rad_per_s, -0.1);
}

TEST(OutlineGuard, StopsBeforeTheFrontOfALongBody) {
  const auto verdict = guard_seeing({{0.65, 0.0}}).judge({0.5, 0.0}, kNow_ns);
  EXPECT_EQ(verdict.allowed, geometry::Velocity{});
  // The same point would be 0.38 m ahead of a round body.
  const auto beside = guard_seeing({{1.0, 0.33}}).judge({0.3, 0.0}, kNow_ns);
  EXPECT_EQ(beside.allowed, (geometry::Velocity{0.3, 0.0}));
}

TEST(OutlineGuard, TheLastGuardWatchesTurns) {
  LastGuard guard(rectangular(), 0.0);
  geometry::OdometrySample odometry;
  odometry.stamp_ns = kNow_ns;
  guard.add(odometry);
  guard.add(scan_of({{0.58, 0.34}}));
  const auto near = guard.judge({0.0, 0.5}, 0.5, kNow_ns);
  EXPECT_EQ(near.verdict, LastGuard::Verdict::kSlower);
  EXPECT_LT(near.allowed.angular_rad_per_s, 0.3);
  EXPECT_EQ(guard.judge({0.0, -0.3}, 0.5, kNow_ns).allowed, (geometry::Velocity{0.0, -0.3}));
}

TEST(OutlineGuard, AFaultyOutlineIsRefused) {
  GuardConfig config;
  config.footprint = {{{0.6, 0.3}, {-0.6, -0.3}, {0.6, -0.3}, {-0.6, 0.3}}};
  EXPECT_THROW(check(config), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::navigation
