// A gateway that freezes at any moment of a drive past obstacles: the base continues with its last
// command until its watchdog expires, and the guard must leave room for that.
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/support/random.hpp"

#include "obstacle_drive.hpp"

namespace topogeo::navigation {
namespace {

DriveGuard guarded_by(CollisionGuard& guard) {
  DriveGuard drive;
  drive.add_odometry = [&guard](const geometry::OdometrySample& sample) {
    guard.add(OdometrySample{sample.stamp_ns, sample.T_odom_robot});
  };
  drive.add_scan = [&guard](const ScanPoints& scan) { guard.add(scan); };
  drive.judge = [&guard](const geometry::Velocity& wanted, std::int64_t now_ns) {
    const GuardVerdict verdict = guard.judge(wanted, now_ns);
    return DriveGuard::Answer{verdict.allowed, verdict.free_m};
  };
  drive.sensors = {30, 110};
  drive.commands = {10, 150};  // the next command takes another 50 ms
  return drive;
}

struct FrozenDrives {
  std::uint64_t contacts = 0;
  double path_m = 0.0;
};

/// Runs separate drives, each frozen at its own moment.
FrozenDrives freeze_drives(int drives, const GuardConfig& config) {
  FrozenDrives outcome;
  support::Random random(5);
  for (int drive = 0; drive < drives; ++drive) {
    CollisionGuard guard(config);
    ObstacleDrive robot(static_cast<std::uint64_t>(100 + drive), guarded_by(guard));
    const std::uint64_t ticks = 200 + random.below(2000);
    for (std::uint64_t i = 0; i < ticks; ++i) robot.tick();
    robot.freeze(geometry::kBaseWatchdog_s);
    outcome.contacts += robot.collisions();
    outcome.path_m += robot.path_m();
  }
  return outcome;
}

TEST(FrozenGateway, TheRobotStopsBeforeWhatItHasSeen) {
  const int drives = std::getenv("TOPOGEO_ALL_FAULTS") != nullptr ? 200 : 40;
  const FrozenDrives outcome = freeze_drives(drives, {});
  EXPECT_EQ(outcome.contacts, 0U);
  EXPECT_GT(outcome.path_m, 2.0 * drives) << "it drives";
}

TEST(FrozenGateway, AGuardThatCountsNoWatchdogLetsItTouch) {
  GuardConfig config;
  config.runs_on_s = 0.0;
  EXPECT_GT(freeze_drives(40, config).contacts, 0U);
}

}  // namespace
}  // namespace topogeo::navigation
