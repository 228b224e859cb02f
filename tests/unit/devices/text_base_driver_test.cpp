#include "topogeo/devices/text_base_driver.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/text_base_emulator.hpp"
#include "topogeo/support/random.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::TextBaseEmulatorSettings;
using testing::HasSubstr;

constexpr std::int64_t kTextTestMs_ns = 1'000'000;
constexpr std::int64_t kTextTestSecond_ns = 1000 * kTextTestMs_ns;

BaseSettings text_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 10.5;
  return settings;
}

/// A driver and an emulated base whose wheels move as its motors want.
struct TextBaseOnLine {
  explicit TextBaseOnLine(const BaseSettings& settings = text_settings(),
                          const TextBaseEmulatorSettings& base = {})
      : driver(settings), emulator(base), line(driver, emulator) {}

  void pass(std::int64_t duration_ns) {
    constexpr std::int64_t kStep_ns = 5 * kTextTestMs_ns;
    constexpr double kStep_s = 1e-9 * kStep_ns;
    for (std::int64_t passed_ns = 0; passed_ns < duration_ns; passed_ns += kStep_ns) {
      const geometry::Velocity wheels = emulator.commanded_velocity();
      truth = truth * geometry::Pose2{0, 0, 0.5 * kStep_s * wheels.angular_rad_per_s} *
              geometry::Pose2{kStep_s * wheels.linear_m_per_s, 0, 0} *
              geometry::Pose2{0, 0, 0.5 * kStep_s * wheels.angular_rad_per_s};
      fastest_mps = std::max(fastest_mps, std::fabs(wheels.linear_m_per_s));
      emulator.moved(kStep_s * wheels.linear_m_per_s, kStep_s * wheels.angular_rad_per_s, kStep_s);
      line.run_for(kStep_ns);
      for (const BaseOdometry& odometry : driver.take_odometry()) {
        EXPECT_GT(odometry.stamp_ns, last.stamp_ns);
        last = odometry;
      }
    }
  }
  void drive(double linear_mps, double angular_radps, std::int64_t duration_ns) {
    for (std::int64_t passed_ns = 0; passed_ns < duration_ns; passed_ns += 100 * kTextTestMs_ns) {
      taken = driver.command(linear_mps, angular_radps, line.now_ns() + 500 * kTextTestMs_ns,
                             line.now_ns());
      pass(100 * kTextTestMs_ns);
    }
  }
  bool start() {
    line.plug_in();
    for (int i = 0; i < 50 && !driver.status().commands_taken; ++i) pass(100 * kTextTestMs_ns);
    return driver.status().commands_taken;
  }
  [[nodiscard]] double speed_mps() const { return emulator.commanded_velocity().linear_m_per_s; }

  TextBaseDriver driver;
  simulation::TextBaseEmulator emulator;
  SimulatedLine line;
  BaseOdometry last{.stamp_ns = std::numeric_limits<std::int64_t>::min()};
  geometry::Pose2 truth;
  double fastest_mps = 0.0;
  bool taken = false;
};

void expect_pose(const TextBaseOnLine& base, double within_m) {
  EXPECT_LT((base.last.T_odom_robot.position_m() - base.truth.position_m()).norm(), within_m);
  EXPECT_NEAR(geometry::wrap_angle(base.last.T_odom_robot.theta_rad - base.truth.theta_rad), 0.0,
              0.02);
}

TEST(TextBaseDriver, DrivesASquareAndKnowsWhereItIs) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  for (int side = 0; side < 4; ++side) {
    base.drive(0.3, 0.0, 3 * kTextTestSecond_ns);
    base.drive(0.0, 0.5, 3 * kTextTestSecond_ns);
  }
  base.drive(0.0, 0.0, 2 * kTextTestSecond_ns);
  expect_pose(base, 0.02);
  EXPECT_LE(base.fastest_mps, 0.31);
  EXPECT_TRUE(base.driver.stands());
  EXPECT_NEAR(base.driver.status().battery_v, 12.3, 1e-9);
  EXPECT_FALSE(base.driver.status().battery_low);
  for (const std::uint64_t drops : base.driver.status().drops) EXPECT_EQ(drops, 0U);
}

TEST(TextBaseDriver, ABaseThatMixesGetsTheSameMotion) {
  BaseSettings settings = text_settings();
  settings.text.mixes = true;
  TextBaseOnLine base(settings);
  ASSERT_TRUE(base.start());
  base.drive(0.2, 0.3, 3 * kTextTestSecond_ns);
  base.drive(0.0, 0.0, kTextTestSecond_ns);
  expect_pose(base, 0.02);
  EXPECT_GT(base.truth.theta_rad, 0.5);
}

TEST(TextBaseDriver, TheHeadingFollowsAGyro) {
  BaseSettings wide = text_settings();
  wide.text.track_m = 0.4;  // twice the true one: the wheels would show half the turn
  TextBaseOnLine base(wide, {.gyro = true});
  ASSERT_TRUE(base.start());
  base.drive(0.0, 0.3, 3 * kTextTestSecond_ns);
  base.drive(0.0, 0.0, kTextTestSecond_ns);
  EXPECT_GT(base.truth.theta_rad, 1.0);
  EXPECT_NEAR(base.last.T_odom_robot.theta_rad, base.truth.theta_rad, 0.05);
}

TEST(TextBaseDriver, AnotherVersionIsRefusedWithAReason) {
  TextBaseOnLine base(text_settings(), {.version = 2});
  EXPECT_FALSE(base.start());
  EXPECT_THAT(base.driver.status().reason, HasSubstr("version 2"));
}

TEST(TextBaseDriver, AnEmergencyStopHoldsUntilAReset) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kTextTestSecond_ns);
  base.emulator.press_emergency_stop();
  base.drive(0.3, 0.0, 200 * kTextTestMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  base.emulator.release_emergency_stop();
  base.drive(0.3, 0.0, kTextTestSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0) << "a command alone moves nothing";
  base.driver.reset_stop(base.line.now_ns());
  base.pass(kTextTestSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.drive(0.3, 0.0, kTextTestSecond_ns);
  EXPECT_GT(base.speed_mps(), 0.1);
}

TEST(TextBaseDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kTextTestSecond_ns);
  base.emulator.press_bumpers(1, base.line.now_ns());
  base.drive(0.3, 0.0, 500 * kTextTestMs_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kBumped);
  base.pass(kTextTestSecond_ns);
  base.drive(0.3, 0.0, 300 * kTextTestMs_ns);
  EXPECT_FALSE(base.taken) << "not further into the obstacle";
  base.pass(kTextTestSecond_ns);
  base.drive(-0.2, 0.0, 500 * kTextTestMs_ns);
  EXPECT_TRUE(base.taken);
}

TEST(TextBaseDriver, ALowBatteryIsReported) {
  TextBaseOnLine base(text_settings(), {.battery_v = 10.2});
  ASSERT_TRUE(base.start());
  base.pass(2 * kTextTestSecond_ns);
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(TextBaseDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 3 * kTextTestSecond_ns);
  base.drive(0.0, 0.0, kTextTestSecond_ns);
  base.emulator.switch_on(base.line.now_ns());
  base.pass(3 * kTextTestSecond_ns);
  ASSERT_TRUE(base.driver.status().commands_taken) << base.driver.status().reason;
  base.drive(0.3, 0.0, kTextTestSecond_ns);
  base.drive(0.0, 0.0, kTextTestSecond_ns);
  expect_pose(base, 0.03);
}

TEST(TextBaseDriver, WhatWasDrivenUnheardIsInThePose) {
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 2 * kTextTestSecond_ns);
  base.emulator.set_fault(simulation::BaseFault::kSilent, true);
  base.drive(0.3, 0.2, 3 * kTextTestSecond_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kOffline);
  base.emulator.set_fault(simulation::BaseFault::kSilent, false);
  base.pass(2 * kTextTestSecond_ns);
  ASSERT_TRUE(base.driver.status().commands_taken);
  EXPECT_EQ(base.driver.status().restarts, 0U);
  expect_pose(base, 0.03);
}

TEST(TextBaseDriver, RefusesSettingsOutOfRange) {
  for (const auto& change : std::vector<std::function<void(BaseSettings&)>>{
           [](BaseSettings& s) { s.text.ticks_per_m = 0.0; },
           [](BaseSettings& s) { s.text.track_m = 20.0; },
           [](BaseSettings& s) { s.watchdog_s = 0.0; }}) {
    BaseSettings settings = text_settings();
    change(settings);
    EXPECT_THROW(TextBaseDriver{settings}, std::invalid_argument);
  }
}

struct TextBaseFaultCase {
  const char* name;
  std::function<void(TextBaseOnLine&, std::int64_t)> inject;  ///< for a time
};

auto with(simulation::BaseFault fault) {
  return [fault](TextBaseOnLine& base, std::int64_t time_ns) {
    base.emulator.set_fault(fault, true);
    base.pass(time_ns);
    base.emulator.set_fault(fault, false);
  };
}

class TextBaseFaults : public testing::TestWithParam<TextBaseFaultCase> {};

// Whatever strikes while the robot drives, its base stands within the watchdog and its braking once
// nobody commands it, no odometry jumps, and it drives again.
TEST_P(TextBaseFaults, AThousandTimes) {
  support::Random random(5);
  TextBaseOnLine base;
  ASSERT_TRUE(base.start());
  std::size_t moving = 0;
  std::size_t jumps = 0;
  std::size_t lame = 0;
  for (int time = 0; time < 1000; ++time) {
    base.drive(0.3, random.below(2) == 0 ? 0.0 : 0.3, 300 * kTextTestMs_ns);
    const geometry::Pose2 before = base.last.T_odom_robot;
    const geometry::Pose2 true_before = base.truth;
    GetParam().inject(base, kTextTestMs_ns * static_cast<std::int64_t>(5 + random.below(400)));
    base.pass(700 * kTextTestMs_ns);
    if (base.speed_mps() != 0.0) ++moving;
    // A base that restarted counts anew, so what it drove unheard is missing, but nothing is added.
    const double shown_m = geometry::between(before, base.last.T_odom_robot).position_m().norm();
    const double true_m = geometry::between(true_before, base.truth).position_m().norm();
    if (shown_m > true_m + 0.02) ++jumps;
    for (int i = 0; i < 50 && !base.driver.status().commands_taken; ++i) {
      base.pass(100 * kTextTestMs_ns);
    }
    base.drive(0.1, 0.0, 200 * kTextTestMs_ns);
    if (!base.taken) ++lame;
  }
  EXPECT_EQ(moving, 0U);
  EXPECT_EQ(jumps, 0U);
  EXPECT_EQ(lame, 0U);
}

const std::vector<TextBaseFaultCase> kTextBaseFaults{
    {"Corrupted", with(simulation::BaseFault::kCorrupted)},
    {"Truncated", with(simulation::BaseFault::kTruncated)},
    {"Silent", with(simulation::BaseFault::kSilent)},
    {"Noise",
     [](TextBaseOnLine& base, std::int64_t time_ns) {
       base.emulator.send_garbage(static_cast<std::size_t>(time_ns / kTextTestMs_ns),
                                  base.line.now_ns());
       base.pass(time_ns);
     }},
    {"Doubled",
     [](TextBaseOnLine& base, std::int64_t time_ns) {
       base.line.set_filter([](std::vector<std::uint8_t>& bytes) {
         bytes.insert(bytes.end(), bytes.begin(), bytes.end());
       });
       base.pass(time_ns);
       base.line.set_filter({});
     }},
    {"Unplugged",
     [](TextBaseOnLine& base, std::int64_t time_ns) {
       base.line.unplug();
       base.pass(time_ns + 400 * kTextTestMs_ns);
       EXPECT_EQ(base.speed_mps(), 0.0) << "the base stops by itself";
       base.line.plug_in();
     }},
    {"Restarted",
     [](TextBaseOnLine& base, std::int64_t time_ns) {
       base.emulator.switch_on(base.line.now_ns());
       base.pass(time_ns);
     }},
    {"HostFrozen", [](TextBaseOnLine& base, std::int64_t time_ns) {
       base.line.freeze_host(true);
       base.pass(time_ns + 500 * kTextTestMs_ns);
       EXPECT_EQ(base.speed_mps(), 0.0) << "the base stops by itself";
       base.line.freeze_host(false);
     }}};

INSTANTIATE_TEST_SUITE_P(All, TextBaseFaults, testing::ValuesIn(kTextBaseFaults),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
