#include "topogeo/navigation/last_guard.hpp"

#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>

#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/navigation/collision_guard.hpp"

#include "obstacle_drive.hpp"

namespace topogeo::navigation {
namespace {

using Verdict = LastGuard::Verdict;

constexpr std::int64_t kGuarded_ns = 5'000'000'000;
constexpr double kRunsOn_s = geometry::kBaseWatchdog_s;
constexpr double kBrake = 0.5;
constexpr double kBody_m = 0.267 + 0.015;

ScanPoints scan_at(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
  ScanPoints scan;
  scan.stamp_ns = stamp_ns;
  scan.points_m = std::move(points_m);
  return scan;
}

LastGuard last_guard_seeing(std::vector<Eigen::Vector2d> points_m, const GuardConfig& config = {}) {
  LastGuard guard(config, kRunsOn_s);
  guard.add(geometry::OdometrySample{kGuarded_ns, {}, 0.0, 0.0});
  guard.add(scan_at(kGuarded_ns, std::move(points_m)));
  return guard;
}

TEST(LastGuard, StopsBeforeWhatTheLaserSeesWhateverIsWanted) {
  const LastGuard guard = last_guard_seeing({{1.0, 0.0}});
  const auto fast = guard.judge({2.0, 1.0}, kBrake, kGuarded_ns);
  EXPECT_EQ(fast.verdict, Verdict::kSlower);
  EXPECT_LT(fast.allowed.linear_m_per_s, 0.75);
  EXPECT_DOUBLE_EQ(fast.allowed.angular_rad_per_s, 0.5 * fast.allowed.linear_m_per_s);
  const double speed = guard.judge({2.0, 0.0}, kBrake, kGuarded_ns).allowed.linear_m_per_s;
  EXPECT_NEAR(speed * (0.1 + kRunsOn_s) + speed * speed / (2.0 * kBrake), 1.0 - kBody_m, 1e-9);
  EXPECT_EQ(last_guard_seeing({{0.26, 0.0}}).judge({0.1, 0.0}, kBrake, kGuarded_ns).verdict,
            Verdict::kObstacle);
}

TEST(LastGuard, LeavesFreeMotionAndTurnsOnTheSpotAlone) {
  const LastGuard guard = last_guard_seeing({{0.27, 0.0}});
  EXPECT_EQ(guard.judge({0.0, 1.0}, kBrake, kGuarded_ns).allowed, (geometry::Velocity{0.0, 1.0}));
  EXPECT_EQ(guard.judge({-0.3, 0.1}, kBrake, kGuarded_ns).allowed, (geometry::Velocity{-0.3, 0.1}))
      << "the laser sees nothing there";
  EXPECT_EQ(last_guard_seeing({{0.0, 0.3}}).judge({1.0, 0.0}, kBrake, kGuarded_ns).verdict,
            Verdict::kAsWanted);
}

TEST(LastGuard, CountsTheAgeOfTheOdometryAndAWeakBrake) {
  LastGuard guard = last_guard_seeing({{1.5, 0.0}});
  const auto speed = [&](double brake, std::int64_t now_ns) {
    return guard.judge({2.0, 0.0}, brake, now_ns).allowed.linear_m_per_s;
  };
  EXPECT_LT(speed(kBrake, kGuarded_ns + 300'000'000), speed(kBrake, kGuarded_ns));
  EXPECT_LT(speed(0.2, kGuarded_ns), speed(kBrake, kGuarded_ns));
  EXPECT_EQ(speed(3.0, kGuarded_ns), speed(kBrake, kGuarded_ns));
}

TEST(LastGuard, CarriesTheScanOnByOdometryThatComesAfterIt) {
  LastGuard guard({}, kRunsOn_s);
  guard.add(geometry::OdometrySample{kGuarded_ns, {}, 0.5, 0.0});
  guard.add(scan_at(kGuarded_ns + 50'000'000, {{2.0, 0.0}}));
  const double before_m = guard.judge({0.5, 0.0}, kBrake, kGuarded_ns + 60'000'000).free_m;
  EXPECT_NEAR(before_m, 2.025 - kBody_m, 1e-9) << "measured 25 mm further on";
  guard.add(geometry::OdometrySample{kGuarded_ns + 100'000'000, {0.05, 0.0, 0.0}, 0.5, 0.0});
  EXPECT_NEAR(guard.judge({0.5, 0.0}, kBrake, kGuarded_ns + 110'000'000).free_m,
              2.0 - 0.025 - kBody_m, 1e-9);
}

TEST(LastGuard, MindsTheArcThatTheBaseIsStillOn) {
  LastGuard guard({}, kRunsOn_s);
  guard.add(geometry::OdometrySample{kGuarded_ns, {}, 0.5, 0.0});
  guard.add(scan_at(kGuarded_ns, {{0.6, 0.0}}));
  EXPECT_LT(guard.judge({0.5, 2.0}, kBrake, kGuarded_ns).allowed.linear_m_per_s, 0.45);
}

TEST(LastGuard, IsBlindWithoutAFreshScan) {
  LastGuard guard({}, kRunsOn_s);
  EXPECT_EQ(guard.judge({0.1, 0.0}, kBrake, kGuarded_ns).verdict, Verdict::kBlind);
  EXPECT_EQ(guard.judge({0.0, 0.4}, kBrake, kGuarded_ns).verdict, Verdict::kAsWanted);
  guard = last_guard_seeing({{3.0, 0.0}});
  EXPECT_EQ(guard.judge({0.1, 0.0}, kBrake, kGuarded_ns).verdict, Verdict::kAsWanted);
  EXPECT_EQ(guard.judge({0.1, 0.0}, kBrake, kGuarded_ns + 1'000'000'000).verdict, Verdict::kBlind);
  GuardConfig by_sonars;
  by_sonars.needs_scan = false;
  guard = last_guard_seeing({{0.5, 0.0}}, by_sonars);
  EXPECT_EQ(guard.judge({0.5, 0.0}, kBrake, kGuarded_ns).verdict, Verdict::kSlower);
  EXPECT_EQ(guard.judge({0.5, 0.0}, kBrake, kGuarded_ns + 1'000'000'000).verdict,
            Verdict::kAsWanted);
}

TEST(LastGuard, IsBlindWithAScanFromTheFuture) {
  LastGuard guard = last_guard_seeing({{3.0, 0.0}});
  guard.add(scan_at(kGuarded_ns + 100'000'000, {{3.0, 0.0}}));
  EXPECT_EQ(guard.judge({0.1, 0.0}, kBrake, kGuarded_ns).verdict, Verdict::kAsWanted);
  guard.add(scan_at(kGuarded_ns + 60'000'000'000, {{3.0, 0.0}}));
  EXPECT_EQ(guard.judge({0.1, 0.0}, kBrake, kGuarded_ns).verdict, Verdict::kBlind);
}

TEST(LastGuard, TakesNothingFromALaserThatHangs) {
  LastGuard guard = last_guard_seeing({{3.0, 0.0}});
  for (int i = 1; i <= 10; ++i) {
    const std::int64_t now_ns = kGuarded_ns + std::int64_t{100'000'000} * i;
    guard.add(geometry::OdometrySample{now_ns, {0.02 * i, 0.0, 0.0}, 0.2, 0.0});
    guard.add(scan_at(now_ns, {{3.0, 0.0}}));
  }
  EXPECT_EQ(guard.judge({0.2, 0.0}, kBrake, kGuarded_ns + 1'000'000'000).verdict, Verdict::kBlind);
}

/// A reckless program on the gateway's own sensors, which may also freeze at any moment.
TEST(LastGuard, NoProgramDrivesIntoWhatTheLaserSees) {
  const int drives = std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 200 : 40;
  std::uint64_t contacts = 0;
  double path_m = 0.0;
  for (int drive = 0; drive < drives; ++drive) {
    LastGuard guard({}, kRunsOn_s);
    DriveGuard hooks;
    hooks.add_odometry = [&guard](const geometry::OdometrySample& sample) { guard.add(sample); };
    hooks.add_scan = [&guard](const ScanPoints& scan) { guard.add(scan); };
    hooks.judge = [&guard](const geometry::Velocity& wanted, std::int64_t now_ns) {
      const LastGuard::Judgement judgement = guard.judge(wanted, ObstacleDrive::kBrake, now_ns);
      return DriveGuard::Answer{judgement.allowed, judgement.free_m};
    };
    hooks.sensors = {30, 60};
    hooks.commands = {10, 40};
    ObstacleDrive robot(static_cast<std::uint64_t>(500 + drive), hooks);
    for (int i = 0; i < 1000 + 7 * drive; ++i) robot.tick();
    robot.freeze(kRunsOn_s);
    contacts += robot.collisions();
    path_m += robot.path_m();
  }
  EXPECT_EQ(contacts, 0U);
  EXPECT_GT(path_m, 2.0 * drives);
}

/// It must not slow down motion that a collision guard permits, or the two would conflict.
TEST(LastGuard, HasNothingToAddToACollisionGuard) {
  int judged = 0;
  int slower = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CollisionGuard first(GuardConfig{});
    LastGuard last({}, kRunsOn_s);
    DriveGuard hooks;
    hooks.add_odometry = [&](const geometry::OdometrySample& sample) {
      first.add(OdometrySample{sample.stamp_ns, sample.T_odom_robot});
      last.add(sample);
    };
    hooks.add_scan = [&](const ScanPoints& scan) {
      first.add(scan);
      last.add(scan);
    };
    hooks.judge = [&](const geometry::Velocity& wanted, std::int64_t now_ns) {
      const GuardVerdict verdict = first.judge(wanted, now_ns);
      const geometry::Velocity allowed = last.judge(verdict.allowed, kBrake, now_ns).allowed;
      ++judged;
      if (allowed.linear_m_per_s < 0.95 * verdict.allowed.linear_m_per_s) ++slower;
      return DriveGuard::Answer{allowed, verdict.free_m};
    };
    hooks.sensors = {30, 110};
    hooks.commands = {10, 150};
    ObstacleDrive robot(seed, hooks);
    for (int i = 0; i < 2000; ++i) robot.tick();
    EXPECT_EQ(robot.collisions(), 0U);
  }
  EXPECT_LT(slower, judged / 100);
}

}  // namespace
}  // namespace topogeo::navigation
