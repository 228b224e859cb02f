// The driver of an iRobot Create 2 against its emulator.
#include "topogeo/devices/create_driver.hpp"

#include <functional>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/simulation/create_emulator.hpp"

#include "two_wheels_on_line.hpp"

namespace topogeo::devices {
namespace {

using simulation::CreateEmulatorSettings;
using testing::HasSubstr;

BaseSettings create_settings() {
  BaseSettings settings;
  settings.line.baud = 115'200;
  settings.battery_low_v = 13.0;
  return settings;
}

struct CreateOnLine : TwoWheelsOnLine<CreateDriver, simulation::CreateEmulator> {
  explicit CreateOnLine(const BaseSettings& settings = create_settings(),
                        const CreateEmulatorSettings& base = {})
      : TwoWheelsOnLine(settings, base) {}
};

TEST(CreateDriver, DrivesASquareAndKnowsWhereItIs) {
  CreateOnLine base;
  drive_a_square(base, 15.5);
  EXPECT_EQ(base.emulator.mode(), CreateMode::kSafe);
}

TEST(CreateDriver, CountsWrapManyTimes) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.45, 0.0, 150 * kWheelsSecond_ns);  // 67 m; the counts wrap after 29 m
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.truth.x_m, 60.0);
  base.expect_pose(0.02);
  EXPECT_EQ(base.driver.status().restarts, 0U);
}

struct CreateFall {
  const char* name;
  std::function<void(simulation::CreateEmulator&, bool)> set;
  const char* reason;
};

class CreateFalls : public testing::TestWithParam<CreateFall> {};

// The device stops by itself and becomes passive; the driver holds it until an operator releases
// it, and it moves with the next command.
TEST_P(CreateFalls, HoldLikeAnEmergencyStopUntilAReset) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  GetParam().set(base.emulator, true);
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.emulator.mode(), CreateMode::kPassive);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_THAT(base.driver.status().reason, HasSubstr(GetParam().reason));
  EXPECT_TRUE(base.driver.held_stops().emergency_stop);
  GetParam().set(base.emulator, false);
  base.drive(0.3, 0.0, 2 * kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0) << "a command alone moves nothing";
  EXPECT_EQ(base.emulator.mode(), CreateMode::kPassive) << "nor does the driver ask for control";
  base.driver.reset_stop(base.line.now_ns());
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.emulator.mode(), CreateMode::kSafe);
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.speed_mps(), 0.1);
}

const std::vector<CreateFall> kCreateFalls{
    {"WheelDrop", [](auto& create, bool on) { create.hang_wheels(on); }, "a wheel hangs"},
    {"Cliff", [](auto& create, bool on) { create.set_cliff(on); }, "sees no floor"},
    {"Dock", [](auto& create, bool on) { create.set_dock(on); }, "on its charger"},
    {"AnotherReason",
     [](auto& create, bool on) {
       if (on) create.leave_safe_mode();
     },
     "has left its safe mode"}};

INSTANTIATE_TEST_SUITE_P(All, CreateFalls, testing::ValuesIn(kCreateFalls),
                         [](const auto& fall) { return std::string(fall.param.name); });

TEST(CreateDriver, AResetWhileAWheelHangsHoldsAgain) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.emulator.hang_wheels(true);
  base.pass(kWheelsSecond_ns);
  base.driver.reset_stop(base.line.now_ns());
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
}

TEST(CreateDriver, AFallThatIsUnheardHoldsToo) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.line.unplug();
  base.emulator.hang_wheels(true);
  base.emulator.hang_wheels(false);
  base.pass(kWheelsSecond_ns);
  base.line.plug_in();
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_EQ(base.emulator.mode(), CreateMode::kPassive);
}

TEST(CreateDriver, ModesCountedFromOneMoreAreUnderstood) {
  CreateOnLine base(create_settings(), {.mode_offset = 1});
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  EXPECT_EQ(base.emulator.mode(), CreateMode::kSafe);
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.leave_safe_mode();
  base.pass(200 * kWheelsMs_ns);
  EXPECT_EQ(base.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_EQ(base.emulator.mode(), CreateMode::kPassive);
}

// The device stays in its safe mode, whose number the driver takes for that of the passive one.
TEST(CreateDriver, ALostStartOrderIsSentAgain) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.line.unplug();
  CreateDriver next(create_settings());  // another life of the program
  SimulatedLine line(next, base.emulator, base.line.now_ns());
  bool lost = false;
  line.set_host_filter([&](std::vector<std::uint8_t>& bytes) {
    if (!lost && bytes == std::vector<std::uint8_t>{create_order::kStart}) {
      bytes.clear();
      lost = true;
    }
  });
  line.plug_in();
  EXPECT_TRUE(line.run_until(10 * kWheelsSecond_ns, [&] { return next.status().commands_taken; }))
      << next.status().reason;
  EXPECT_TRUE(lost);
}

// The stream is slower than stated, and has no time.
TEST(CreateDriver, StampsAndSpeedsAreThoseOfTheRobot) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 60 * kWheelsSecond_ns);
  const std::int64_t age_ns = base.line.now_ns() - base.last.stamp_ns;
  EXPECT_GE(age_ns, 0);
  EXPECT_LT(age_ns, 30 * kWheelsMs_ns);
  EXPECT_NEAR(base.last.linear_mps, 0.3, 0.03) << "a tick is a tenth of a frame";
}

TEST(CreateDriver, ARobotOnItsDockWaitsWithoutAnEmergencyStop) {
  CreateOnLine base;
  base.emulator.set_dock(true);
  EXPECT_FALSE(base.start());
  EXPECT_EQ(base.driver.status().state, BaseState::kStarting);
  EXPECT_THAT(base.driver.status().reason, HasSubstr("on its charger"));
  base.emulator.set_dock(false);
  EXPECT_TRUE(base.wait_for_commands());
}

TEST(CreateDriver, AFastCommandIsSlowerOnTheSameArc) {
  CreateOnLine base;
  keep_the_arc_of_fast_commands(base);
}

TEST(CreateDriver, ABumperStopsTheBaseAndLetsItBackOff) {
  CreateOnLine base;
  back_off_from_a_bump(base, 3U);  // right and left
}

TEST(CreateDriver, ADeviceThatRunsOnFromAKilledProgramIsStoppedFirst) {
  CreateOnLine base;
  run_on_from_a_killed_program(base);
}

TEST(CreateDriver, StopBytesStopEvenBehindAnOrderThatWasCut) {
  CreateOnLine base;
  ASSERT_TRUE(base.start());
  const std::vector<std::uint8_t> order = create_drive(300.0, 300.0);
  for (std::size_t size = 0; size <= order.size(); ++size) {
    base.drive(0.3, 0.0, kWheelsSecond_ns);
    base.line.freeze_host(true);
    base.emulator.receive(std::span(order).first(size), base.host, base.line.now_ns());
    base.emulator.receive(base.driver.stop_bytes(), base.host, base.line.now_ns());
    base.pass(kWheelsSecond_ns);
    EXPECT_EQ(base.speed_mps(), 0.0) << size;
    base.line.freeze_host(false);
    base.pass(kWheelsSecond_ns);
  }
}

TEST(CreateDriver, ALowBatteryIsReported) {
  CreateOnLine base(create_settings(), {.battery_v = 12.5});
  ASSERT_TRUE(base.start());
  EXPECT_TRUE(base.driver.status().battery_low);
}

TEST(CreateDriver, TheChargeOfTheBatteryIsReportedIfItsCapacityIsKnown) {
  const auto percent = [](std::uint16_t charge_mah, std::uint16_t capacity_mah) {
    CreateOnLine base(create_settings(), {.charge_mah = charge_mah, .capacity_mah = capacity_mah});
    EXPECT_TRUE(base.start());
    return base.driver.status().battery_percent;
  };
  EXPECT_EQ(percent(1'300, 2'600), 50.0);
  EXPECT_EQ(percent(2'700, 2'600), 100.0) << "more than the stated capacity";
  EXPECT_FALSE(percent(1'300, 0));
}

TEST(CreateDriver, ThePoseGoesOnWhenTheBaseRestarts) {
  CreateOnLine base;
  restart_on_the_way(base, 4 * kWheelsSecond_ns);
  EXPECT_EQ(base.driver.status().restarts, 1U);
}

TEST(CreateDriver, RefusesSettingsOutOfRange) {
  expect_settings_refused<CreateDriver>(
      create_settings(),
      {[](BaseSettings& s) { s.create.ticks_per_m = 0.0; },
       [](BaseSettings& s) { s.create.track_m = 20.0; }, [](BaseSettings& s) { s.line.baud = 0; }});
}

class CreateFaults : public testing::TestWithParam<TwoWheelFault<CreateOnLine>> {};

TEST_P(CreateFaults, AThousandTimes) {
  CreateOnLine base;
  strike_a_thousand_times(base, GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, CreateFaults, testing::ValuesIn(two_wheel_faults<CreateOnLine>()),
                         [](const auto& fault) { return std::string(fault.param.name); });

}  // namespace
}  // namespace topogeo::devices
