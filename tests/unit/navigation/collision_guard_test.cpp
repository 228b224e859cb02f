#include "topogeo/navigation/collision_guard.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "topogeo/scan/scan.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kNow_ns = 5'000'000'000;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

CollisionGuard guard_seeing(const std::vector<Eigen::Vector2d>& points_m,
                            const GuardConfig& config = {}) {
  CollisionGuard guard(config);
  guard.add(OdometrySample{kNow_ns, {}});
  ScanPoints scan;
  scan.stamp_ns = kNow_ns;
  scan.points_m = points_m;
  guard.add(scan);
  return guard;
}

SonarRound round_at(std::int64_t stamp_ns, const geometry::Pose2& T_robot_sonar, float range_m) {
  return {stamp_ns, {{T_robot_sonar, 0.2, range_m}}};
}

/// Distance driven at this speed from the guard's last scan until the base has braked.
double stopping_m(double speed, double age_s, const GuardConfig& config) {
  return speed * (age_s + config.delay_s + config.runs_on_s) +
         speed * speed / (2.0 * config.deceleration_m_per_s2);
}

TEST(CollisionGuard, NothingNearChangesNothing) {
  const auto verdict = guard_seeing({{0.0, 2.0}}).judge({0.5, 0.1}, kNow_ns);
  EXPECT_EQ(verdict.allowed, (geometry::Velocity{0.5, 0.1}));
  EXPECT_FALSE(verdict.limited);
  EXPECT_EQ(verdict.reason, HaltReason::kNone);
  EXPECT_DOUBLE_EQ(verdict.free_m, CollisionGuard::kFarthest_m);
}

TEST(CollisionGuard, StraightAheadItStopsAtTheMargin) {
  // 1 m to the middle: 0.733 m to the body, less the side margin around the body.
  const GuardConfig config;
  const auto verdict = guard_seeing({{1.0, 0.0}}).judge({2.0, 0.0}, kNow_ns);
  EXPECT_NEAR(verdict.free_m, 1.0 - config.radius_m - config.side_margin_m, 1e-9);
  const double distance_m = 1.0 - config.radius_m - config.margin_m;
  EXPECT_NEAR(stopping_m(verdict.allowed.linear_m_per_s, 0.0, config), distance_m, 1e-9);
  EXPECT_TRUE(verdict.limited);
  ASSERT_TRUE(verdict.contact_m);
  EXPECT_NEAR(verdict.contact_m->x(), 1.0, 1e-9);
}

TEST(CollisionGuard, CountsTheAgeOfTheOdometry) {
  const GuardConfig config;
  CollisionGuard guard = guard_seeing({{1.0, 0.0}});
  guard.add(OdometrySample{kNow_ns + kSecond_ns / 10, {0.1, 0.0, 0.0}});
  const auto speed_at = [&](std::int64_t after_ns) {
    return guard.judge({2.0, 0.0}, kNow_ns + after_ns).allowed.linear_m_per_s;
  };
  const double distance_m = 0.9 - config.radius_m - config.margin_m;
  EXPECT_NEAR(stopping_m(speed_at(kSecond_ns / 10), 0.0, config), distance_m, 1e-9);
  EXPECT_NEAR(stopping_m(speed_at(kSecond_ns / 2), 0.4, config), distance_m, 1e-9);
  // Stamps ahead of the clock give no additional time.
  EXPECT_EQ(speed_at(0), speed_at(kSecond_ns / 10));
}

TEST(CollisionGuard, CountsTheAgeOfTheScanWithoutOdometry) {
  const GuardConfig config;
  CollisionGuard guard(config);
  ScanPoints scan;
  scan.stamp_ns = kNow_ns;
  scan.points_m = {{1.0, 0.0}};
  guard.add(scan);
  const auto verdict = guard.judge({2.0, 0.0}, kNow_ns + kSecond_ns / 4);
  EXPECT_NEAR(stopping_m(verdict.allowed.linear_m_per_s, 0.25, config),
              1.0 - config.radius_m - config.margin_m, 1e-9);
}

TEST(CollisionGuard, BeforeAWallNothingButATurnIsAllowed) {
  const CollisionGuard guard = guard_seeing({{0.31, 0.0}});
  EXPECT_EQ(guard.judge({0.3, 0.2}, kNow_ns).allowed, geometry::Velocity{});
  EXPECT_EQ(guard.judge({0.3, 0.2}, kNow_ns).reason, HaltReason::kObstacle);
  EXPECT_EQ(guard.judge({0.0, 0.7}, kNow_ns).allowed, (geometry::Velocity{0.0, 0.7}));
}

TEST(CollisionGuard, WhatIsBesideDoesNotStopIt) {
  std::vector<Eigen::Vector2d> wall_m;
  for (int i = -20; i < 100; ++i) wall_m.emplace_back(0.05 * i, 0.32);
  EXPECT_EQ(guard_seeing(wall_m).judge({0.5, 0.0}, kNow_ns).allowed.linear_m_per_s, 0.5);
  EXPECT_LT(guard_seeing(wall_m).judge({0.5, 0.3}, kNow_ns).allowed.linear_m_per_s, 0.5);
}

TEST(CollisionGuard, OdometryCarriesTheScanOn) {
  CollisionGuard guard = guard_seeing({{1.0, 0.0}});
  const double before_m = guard.judge({0.1, 0.0}, kNow_ns).free_m;
  guard.add(OdometrySample{kNow_ns + 100'000'000, {0.3, 0.0, 0.0}});
  EXPECT_NEAR(guard.judge({0.1, 0.0}, kNow_ns + 100'000'000).free_m, before_m - 0.3, 1e-9);
}

TEST(CollisionGuard, WithoutAFreshScanNothingIsAllowed) {
  const CollisionGuard none{GuardConfig{}};
  EXPECT_EQ(none.judge({0.0, 0.5}, kNow_ns).allowed, geometry::Velocity{});
  EXPECT_EQ(none.judge({0.0, 0.5}, kNow_ns).reason, HaltReason::kNoScan);
  const CollisionGuard guard = guard_seeing({{3.0, 0.0}});
  EXPECT_EQ(guard.judge({0.2, 0.0}, kNow_ns + kSecond_ns).reason, HaltReason::kNoScan);
  EXPECT_EQ(guard.judge({0.2, 0.0}, kNow_ns + kSecond_ns / 2).reason, HaltReason::kNone);
}

TEST(CollisionGuard, ASonarSeesWhatTheLaserDoesNot) {
  CollisionGuard guard = guard_seeing({{4.0, 0.0}});
  guard.add(round_at(kNow_ns, {0.267, 0.0, 0.0}, 0.5F));
  const GuardConfig config;
  EXPECT_NEAR(guard.judge({0.1, 0.0}, kNow_ns).free_m, 0.5 - config.side_margin_m, 1e-6);
}

TEST(CollisionGuard, TheLaserKnowsBetterWhereAnEchoComesFrom) {
  // A door post whose echo the sonar places on its axis.
  CollisionGuard guard = guard_seeing({{0.75, 0.08}});
  guard.add(round_at(kNow_ns, {0.267, 0.0, 0.0}, 0.49F));
  const double free_m = guard.judge({0.1, 0.0}, kNow_ns).free_m;
  EXPECT_NEAR(free_m, 0.75 - std::sqrt(0.287 * 0.287 - 0.08 * 0.08), 1e-9);
}

TEST(CollisionGuard, AnEchoCountsWhereTheScanThatSawItsSourceIsTooOld) {
  GuardConfig config;
  config.needs_scan = false;
  CollisionGuard guard = guard_seeing({{0.75, 0.08}}, config);
  const geometry::Pose2 mount{0.267, 0.0, 0.0};
  guard.add(round_at(kNow_ns + kSecond_ns, mount, 0.49F));
  const GuardVerdict verdict = guard.judge({0.1, 0.0}, kNow_ns + kSecond_ns);
  EXPECT_EQ(verdict.reason, HaltReason::kNone);
  EXPECT_NEAR(verdict.free_m, 0.49 - config.side_margin_m, 1e-6);
}

TEST(CollisionGuard, WhatAnOldScanSawNeedNotBeHeard) {
  GuardConfig config;
  config.needs_scan = false;
  CollisionGuard guard = guard_seeing({{1.0, 0.0}}, config);
  const geometry::Pose2 mount{0.267, 0.0, 0.0};
  guard.add(round_at(kNow_ns + 5 * kSecond_ns, mount, scan::Scan::kNoReturn));
  guard.add(round_at(kNow_ns + 7 * kSecond_ns, mount, scan::Scan::kNoReturn));
  EXPECT_EQ(guard.health(kNow_ns + 7 * kSecond_ns), HaltReason::kNone);
}

TEST(CollisionGuard, BackwardsOnlyWhereASonarLooks) {
  CollisionGuard guard = guard_seeing({{3.0, 0.0}});
  EXPECT_EQ(guard.judge({-0.1, 0.0}, kNow_ns).allowed, geometry::Velocity{});
  guard.add(round_at(kNow_ns, {-0.267, 0.0, std::numbers::pi}, 1.0F));
  EXPECT_EQ(guard.judge({-0.1, 0.0}, kNow_ns).allowed, (geometry::Velocity{-0.1, 0.0}));
  guard.add(round_at(kNow_ns + 1, {-0.267, 0.0, std::numbers::pi}, 0.03F));
  EXPECT_EQ(guard.judge({-0.1, 0.0}, kNow_ns + 1).allowed, geometry::Velocity{});
}

TEST(CollisionGuard, SonarsThatMustHearAndDoNotAreSilent) {
  GuardConfig config;
  config.oldest_scan_s = 5.0;
  CollisionGuard guard = guard_seeing({{1.0, 0.0}}, config);
  const geometry::Pose2 mount{0.267, 0.0, 0.0};
  guard.add(round_at(kNow_ns, mount, scan::Scan::kNoReturn));
  EXPECT_EQ(guard.health(kNow_ns), HaltReason::kNone);
  guard.add(round_at(kNow_ns + kSecond_ns, mount, scan::Scan::kNoReturn));
  EXPECT_EQ(guard.health(kNow_ns + kSecond_ns), HaltReason::kSonarSilent);
  guard.add(round_at(kNow_ns + 2 * kSecond_ns, mount, 0.7F));
  EXPECT_EQ(guard.health(kNow_ns + 2 * kSecond_ns), HaltReason::kNone);
}

TEST(CollisionGuard, SonarsWithNothingNearMayBeSilent) {
  GuardConfig config;
  config.oldest_scan_s = 5.0;
  CollisionGuard guard = guard_seeing({{3.0, 0.0}}, config);
  const geometry::Pose2 mount{0.267, 0.0, 0.0};
  guard.add(round_at(kNow_ns, mount, scan::Scan::kNoReturn));
  guard.add(round_at(kNow_ns + kSecond_ns, mount, scan::Scan::kNoReturn));
  EXPECT_EQ(guard.health(kNow_ns + kSecond_ns), HaltReason::kNone);
}

// Nothing is near in the scan: only the fields decide.
TEST(CollisionGuard, ObeysTheFieldsOfTheLaser) {
  GuardConfig config;
  CollisionGuard guard = guard_seeing({{0.0, 3.0}});
  guard.add(LaserFields{kNow_ns, true, false});
  const auto slowed = guard.judge({0.8, 0.4}, kNow_ns);
  EXPECT_DOUBLE_EQ(slowed.allowed.linear_m_per_s, config.warning_field_m_per_s);
  EXPECT_DOUBLE_EQ(slowed.allowed.angular_rad_per_s, 0.1);  // on the same arc
  EXPECT_TRUE(slowed.limited);
  EXPECT_EQ(slowed.reason, HaltReason::kNone);
  guard.add(LaserFields{kNow_ns + 1, true, true});
  EXPECT_EQ(guard.judge({0.1, 0.0}, kNow_ns).allowed, geometry::Velocity{});
  EXPECT_EQ(guard.judge({0.1, 0.0}, kNow_ns).reason, HaltReason::kObstacle);
  EXPECT_EQ(guard.judge({0.0, 0.7}, kNow_ns).allowed, (geometry::Velocity{0.0, 0.7}));
  guard.add(LaserFields{kNow_ns, false, false});  // older than the previous one
  EXPECT_EQ(guard.judge({0.1, 0.0}, kNow_ns).allowed, geometry::Velocity{});
  guard.add(LaserFields{kNow_ns + 2, false, false});
  EXPECT_EQ(guard.judge({0.8, 0.4}, kNow_ns).allowed, (geometry::Velocity{0.8, 0.4}));
}

TEST(CollisionGuard, LeavesTheFieldsOfTheLaserAloneWhenToldTo) {
  GuardConfig config;
  config.laser_fields = false;
  CollisionGuard guard = guard_seeing({{0.0, 3.0}}, config);
  guard.add(LaserFields{kNow_ns, true, true});
  EXPECT_EQ(guard.judge({0.5, 0.0}, kNow_ns).allowed, (geometry::Velocity{0.5, 0.0}));
}

TEST(CollisionGuard, SettingsOutOfRangeAreRefused) {
  GuardConfig config;
  config.radius_m = 0.0;
  EXPECT_THAT([&] { CollisionGuard{config}; },
              testing::ThrowsMessage<std::invalid_argument>(testing::StrEq(
                  "key 'guard.radius_m' = '0': expected number between 0.05 and 2 m")));
  config = {};
  config.delay_s = NAN;
  EXPECT_THROW(CollisionGuard{config}, std::invalid_argument);
}

/// Drives on as permitted until the base brakes; returns the least distance of the points to the
/// middle, in steps of a millimetre.
double nearest_m(const std::vector<Eigen::Vector2d>& points_m, const geometry::Velocity& allowed,
                 const GuardConfig& config) {
  const double stop_m = stopping_m(std::fabs(allowed.linear_m_per_s), 0.0, config);
  const double curvature = allowed.angular_rad_per_s / allowed.linear_m_per_s;
  double least_m = HUGE_VAL;
  double x_m = 0.0;
  double y_m = 0.0;
  constexpr double kPiece_m = 0.001;
  for (double distance_m = 0.0; distance_m <= stop_m; distance_m += kPiece_m) {
    for (const auto& point_m : points_m) {
      least_m = std::min(least_m, (point_m - Eigen::Vector2d(x_m, y_m)).norm());
    }
    const double heading_rad = curvature * (distance_m + 0.5 * kPiece_m);
    x_m += kPiece_m * std::cos(heading_rad);
    y_m += kPiece_m * std::sin(heading_rad);
  }
  return least_m;
}

TEST(CollisionGuard, WhateverItSeesAndIsToldTheBodyTouchesNothing) {
  support::Random random(7);
  int limited = 0;
  int stopped = 0;
  for (int run = 0; run < 3000; ++run) {
    GuardConfig config;
    config.margin_m = random.uniform(0.02, 0.2);
    config.delay_s = random.uniform(0.0, 0.5);
    config.runs_on_s = random.uniform(0.0, 1.0);
    config.deceleration_m_per_s2 = random.uniform(0.2, 1.0);
    std::vector<Eigen::Vector2d> points_m;
    const int count = static_cast<int>(random.uniform(0.0, 40.0));
    for (int i = 0; i < count; ++i) {
      const double angle_rad = random.uniform(-0.5, 0.5) * std::numbers::pi;
      const double range_m = random.uniform(config.radius_m + 0.002, 3.0);
      points_m.emplace_back(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad));
    }
    const geometry::Velocity wanted{random.uniform(0.02, 1.5), random.uniform(-2.0, 2.0)};
    const GuardVerdict verdict = guard_seeing(points_m, config).judge(wanted, kNow_ns);
    EXPECT_LE(verdict.allowed.linear_m_per_s, wanted.linear_m_per_s);
    if (verdict.limited) ++limited;
    if (verdict.allowed == geometry::Velocity{}) {
      ++stopped;
      continue;
    }
    EXPECT_NEAR(verdict.allowed.angular_rad_per_s * wanted.linear_m_per_s,
                wanted.angular_rad_per_s * verdict.allowed.linear_m_per_s, 1e-9);
    ASSERT_GT(nearest_m(points_m, verdict.allowed, config), config.radius_m) << "run " << run;
  }
  EXPECT_GT(limited, 500);
  EXPECT_GT(stopped, 50);
  EXPECT_LT(stopped, 2500);
}

}  // namespace
}  // namespace topogeo::navigation
