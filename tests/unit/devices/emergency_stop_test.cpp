// The emergency stop of a base without a message for it: pressed at any moment of a drive, for any
// time, on the clock of the emulated base. Ordinary drives must never trigger it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "base_lines.hpp"
#include "power_drive.hpp"

namespace topogeo::devices {
namespace {

// m/s and rad/s. Encoder noise of a base at rest: 256 counts/s of a B21 (MIRO), and three counts of
// the rotation.
constexpr double kLinearNoise = 0.009;
constexpr double kAngularNoise = 0.018;

bool all_of_them() {
  return std::getenv("TOPOGEO_ALL_FAULTS") != nullptr;
}

class EmergencyStopOn : public BaseOnAnyLine {
 protected:
  /// Executes the drive's commands for so long.
  static void follow(BaseOnLine& all, OrdinaryDrive& drive, std::int64_t duration_ns) {
    const std::int64_t end_ns = all.line.now_ns() + duration_ns;
    while (all.line.now_ns() < end_ns) {
      const BaseVelocity wanted = drive.next();
      (void)all.driver.command(wanted.linear_mps, wanted.angular_radps,
                               all.line.now_ns() + 300 * kMs, all.line.now_ns());
      all.pass(OrdinaryDrive::kPeriod_ns);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Dialects, EmergencyStopOn, testing::ValuesIn(kWays), name_of);

TEST_P(EmergencyStopOn, IsNeverNoticedInOrdinaryDrives) {
  const int drives = all_of_them() ? 200 : 10;
  for (int number = 0; number < drives; ++number) {
    BaseOnLine all(settings());
    all.base.set_noise(kLinearNoise, kAngularNoise);
    ASSERT_TRUE(all.start());
    OrdinaryDrive drive(static_cast<std::uint64_t>(number));
    for (int leg = 0; leg < 60; ++leg) {
      follow(all, drive, kSecond);
      ASSERT_NE(all.driver.status().state, BaseState::kEmergencyStop)
          << "drive " << number << " after " << leg << " s";
    }
  }
}

/// The gateway waits for a CPU, and so does the commanding program.
TEST_P(EmergencyStopOn, IsNeverNoticedWhereTheHostIsBusy) {
  BaseOnLine all(settings());
  all.base.set_noise(kLinearNoise, kAngularNoise);
  ASSERT_TRUE(all.start());
  OrdinaryDrive drive(3);
  support::Random random(4);
  for (int i = 0; i < (all_of_them() ? 5000 : 500); ++i) {
    follow(all, drive, 400 * kMs);
    all.line.freeze_host(true);
    all.pass(static_cast<std::int64_t>(random.below(700)) * kMs);
    all.line.freeze_host(false);
    ASSERT_NE(all.driver.status().state, BaseState::kEmergencyStop) << i;
  }
}

/// The gateway has time, but the thread that writes to its port waits for a CPU.
TEST_P(EmergencyStopOn, IsNeverNoticedWhereWhatIsCommandedIsWrittenLate) {
  BaseOnLine all(settings());
  all.base.set_noise(kLinearNoise, kAngularNoise);
  ASSERT_TRUE(all.start());
  OrdinaryDrive drive(5);
  support::Random random(6);
  for (int i = 0; i < (all_of_them() ? 5000 : 500); ++i) {
    follow(all, drive, 400 * kMs);
    all.line.hold_orders(true);
    follow(all, drive, static_cast<std::int64_t>(random.below(900)) * kMs);
    all.line.hold_orders(false);
    ASSERT_NE(all.driver.status().state, BaseState::kEmergencyStop) << i;
  }
}

/// The emulated base waits for a CPU; the gateway goes on, or waits, too.
TEST_P(EmergencyStopOn, IsNeverNoticedWhereTheEmulatedBaseWaits) {
  BaseOnLine all(settings());
  all.base.set_noise(kLinearNoise, kAngularNoise);
  ASSERT_TRUE(all.start());
  OrdinaryDrive drive(7);
  support::Random random(8);
  for (int i = 0; i < (all_of_them() ? 5000 : 500); ++i) {
    follow(all, drive, 400 * kMs);
    all.base.freeze();
    follow(all, drive, static_cast<std::int64_t>(random.below(400)) * kMs);
    all.line.freeze_host(random.below(2) == 0);
    all.pass(static_cast<std::int64_t>(random.below(300)) * kMs);
    all.base.thaw(all.line.now_ns());
    all.pass(static_cast<std::int64_t>(random.below(100)) * kMs);
    all.line.freeze_host(false);
    ASSERT_NE(all.driver.status().state, BaseState::kEmergencyStop) << i;
  }
}

/// Motion of the wheels with and without the emergency stop.
struct TwinDrive {
  explicit TwinDrive(const BaseSettings& settings, std::uint64_t seed)
      : all(settings), drive(seed) {
    all.base.set_noise(kLinearNoise, kAngularNoise);
  }
  BaseOnLine all;
  OrdinaryDrive drive;
};

TEST_P(EmergencyStopOn, HoldsTheRobotUntilResetHoweverShortItWas) {
  const int stops = all_of_them() ? 200 : 25;
  int hindered = 0;
  int unnoticed = 0;
  support::Random random(11);
  for (int number = 0; number < stops; ++number) {
    const auto seed = std::uint64_t{1000} + static_cast<std::uint64_t>(number);
    TwinDrive stopped(settings(), seed);
    TwinDrive twin(settings(), seed);
    ASSERT_TRUE(stopped.all.start() && twin.all.start());
    const std::int64_t at_ns = kSecond + static_cast<std::int64_t>(random.below(10'000)) * kMs;
    follow(stopped.all, stopped.drive, at_ns);
    follow(twin.all, twin.drive, at_ns);
    const std::int64_t into_ns = static_cast<std::int64_t>(random.below(50)) * kMs;
    stopped.all.pass(into_ns);
    twin.all.pass(into_ns);
    // A tenth of a second to ten, log-uniform.
    const std::int64_t pressed_ns = std::llround(1e8 * std::pow(100.0, random.uniform(0.0, 1.0)));
    stopped.all.base.mcp.press_emergency_stop();
    double lost = 0.0;  // missing speed relative to a working motor; from 1 on it must be noticed
    const auto compare = [&] {
      const geometry::Velocity now = stopped.all.base.mcp.commanded_velocity();
      const geometry::Velocity healthy = twin.all.base.mcp.commanded_velocity();
      lost = std::max(
          {lost, (std::fabs(healthy.linear_m_per_s) - std::fabs(now.linear_m_per_s)) / 0.05,
           (std::fabs(healthy.angular_rad_per_s) - std::fabs(now.angular_rad_per_s)) / 0.15});
    };
    for (std::int64_t passed_ns = 0; passed_ns < pressed_ns;
         passed_ns += OrdinaryDrive::kPeriod_ns) {
      follow(stopped.all, stopped.drive, 1);
      follow(twin.all, twin.drive, 1);
      compare();
    }
    stopped.all.base.mcp.release_emergency_stop();
    follow(stopped.all, stopped.drive, 1500 * kMs);
    if (lost < 1.0) continue;  // the robot stood, or braked anyway
    ++hindered;
    const BaseState state = stopped.all.driver.status().state;
    if (state != BaseState::kEmergencyStop) ++unnoticed;
    EXPECT_EQ(state, BaseState::kEmergencyStop)
        << "stop " << number << " of " << pressed_ns / kMs << " ms, lost " << lost;
    if (state != BaseState::kEmergencyStop) continue;
    follow(stopped.all, stopped.drive, 3 * kSecond);
    EXPECT_TRUE(stopped.all.base.stands());
    stopped.all.driver.reset_stop(stopped.all.line.now_ns());
    stopped.all.drive(0.3, 0.2, 3 * kSecond);
    EXPECT_EQ(stopped.all.driver.status().state, BaseState::kMoving) << number;
  }
  EXPECT_EQ(unnoticed, 0);
  EXPECT_GT(hindered, stops / 3);
}

}  // namespace
}  // namespace topogeo::devices
