// All events that must stop the robot, and the status that they produce.
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base_lines.hpp"

namespace topogeo::devices {
namespace {

using testing::Contains;

class BaseSafetyOn : public BaseOnAnyLine {};

INSTANTIATE_TEST_SUITE_P(Dialects, BaseSafetyOn, testing::ValuesIn(kWays), name_of);

TEST_P(BaseSafetyOn, HaltsWhenCommandsCease) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.4, 0.2, 3 * kSecond);
  all.base.mcp.forget_orders();
  const std::int64_t last_ns = all.line.now_ns() - kSecond / 10;
  const auto halted = [&] {
    const auto& orders = all.base.mcp.orders();
    return std::ranges::count(orders, McpOrder{McpCommand::kTranslateHalt}) > 0 &&
           std::ranges::count(orders, McpOrder{McpCommand::kRotateHalt}) > 0;
  };
  ASSERT_TRUE(all.pass_until(kSecond, halted));
  EXPECT_NEAR(static_cast<double>(all.line.now_ns() - last_ns), 0.53e9, 0.03e9);
  all.pass(3 * kSecond);
  EXPECT_TRUE(all.base.stands());
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  all.drive(0.4, 0.0, 2 * kSecond);
  EXPECT_FALSE(all.base.stands());
}

TEST_P(BaseSafetyOn, TheBaseStopsByItselfWhenTheDriverIsGone) {
  for (const bool limps : {false, true}) {
    BaseOnLine all(settings(), {.watchdog_limps = limps});
    ASSERT_TRUE(all.start());
    all.drive(0.4, 0.2, 3 * kSecond);
    ASSERT_FALSE(all.base.stands());
    all.line.unplug();
    all.pass(3 * kSecond);
    EXPECT_TRUE(all.base.stands());
    EXPECT_EQ(all.driver.status().state, BaseState::kOffline);
    EXPECT_FALSE(all.driver.status().commands_taken);
    EXPECT_FALSE(all.driver.command(0.4, 0.2, all.line.now_ns() + kSecond, all.line.now_ns()));
    ASSERT_TRUE(all.start());
    all.pass(2 * kSecond);
    EXPECT_TRUE(all.base.stands());
    all.drive(0.4, 0.2, 2 * kSecond);
    EXPECT_FALSE(all.base.stands());
    EXPECT_LT(all.worst_m, 0.02);
    EXPECT_EQ(all.stamps_back, 0U);
  }
}

TEST_P(BaseSafetyOn, SaysThatTheWatchdogExpired) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.base.mcp.receive({}, settings().line, all.line.now_ns());
  // Another program on the line sets a watchdog that is too short.
  std::vector<std::uint8_t> bytes;
  const McpOrder order{McpCommand::kWatchdog, 2};
  if (GetParam().dialect == BaseDialect::kAscii) {
    append_ascii(order, bytes);
  } else {
    const McpPacket packet = binary_packet(order);
    bytes.assign(packet.begin(), packet.end());
  }
  // The driver may be refreshing its own watchdog.
  while (all.driver.status().watchdog_expirations == 0) {
    all.base.mcp.receive(bytes, settings().line, all.line.now_ns());
    all.pass(50 * kMs);
  }
  ASSERT_TRUE(all.pass_until(
      kSecond, [&] { return all.driver.status().state == BaseState::kWatchdogExpired; }));
  EXPECT_NE(all.driver.status().reason, "");
  all.pass(2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kWatchdogExpired);
  EXPECT_TRUE(all.base.stands());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  EXPECT_FALSE(all.base.stands());
  EXPECT_EQ(all.driver.status().watchdog_expirations, 1U);
}

/// The gateway gets no CPU for a while: the base must not stop before its watchdog's time.
TEST_P(BaseSafetyOn, ABusyHostLetsTheWatchdogExpireNoSoonerThanItMust) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  for (const std::int64_t busy_ns : {50 * kMs, 100 * kMs, 150 * kMs, 200 * kMs}) {
    for (int i = 0; i < 20; ++i) {
      all.drive(0.3, 0.1, 300 * kMs);
      all.line.freeze_host(true);
      all.pass(busy_ns);
      all.line.freeze_host(false);
    }
    EXPECT_EQ(all.driver.status().watchdog_expirations, 0U) << busy_ns;
  }
}

TEST_P(BaseSafetyOn, AFrozenHostIsTheEndOfTheMotionWithinTheWatchdogsTime) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.4, 0.0, 3 * kSecond);
  all.line.freeze_host(true);
  const std::int64_t frozen_ns = all.line.now_ns();
  ASSERT_TRUE(all.pass_until(
      kSecond, [&] { return all.base.mcp.commanded_velocity().linear_m_per_s < 0.399; }));
  EXPECT_LE(all.line.now_ns() - frozen_ns, 310 * kMs);
  all.pass(5 * kSecond);
  EXPECT_TRUE(all.base.stands());
}

TEST_P(BaseSafetyOn, AfterAFrozenHostItDrivesOnWithFreshCommandsAlone) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  for (int i = 0; i < 10; ++i) {
    all.drive(0.3, 0.0, 2 * kSecond);
    all.line.freeze_host(true);
    all.pass((400 + 150 * i) * kMs);
    all.line.freeze_host(false);
    all.pass(kSecond);
    EXPECT_TRUE(all.base.stands()) << "commands of before hold no more";
    EXPECT_TRUE(all.driver.status().commands_taken) << base_state_name(all.driver.status().state);
    all.drive(0.3, 0.0, kSecond);
    EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  }
  // Without any command the state ends by itself, so that nothing waits forever.
  all.line.freeze_host(true);
  all.pass(400 * kMs);
  all.line.freeze_host(false);
  EXPECT_TRUE(
      all.pass_until(10 * kSecond, [&] { return all.driver.status().state == BaseState::kReady; }));
}

TEST_P(BaseSafetyOn, TheEmergencyStopHaltsAndTheRobotDoesNotJumpWhenPowerReturns) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.4, 0.0, 3 * kSecond);
  all.base.mcp.forget_orders();
  all.base.mcp.press_emergency_stop();
  all.drive(0.4, 0.0, 2 * kSecond);  // the sender keeps commanding
  EXPECT_EQ(all.driver.status().state, BaseState::kEmergencyStop);
  EXPECT_FALSE(all.driver.status().commands_taken);
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kTranslateHalt}));
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kRotateHalt}));
  all.base.mcp.release_emergency_stop();
  const geometry::Pose2 before = all.base.mcp.T_start_robot();
  all.drive(0.4, 0.0, 3 * kSecond);
  EXPECT_EQ(all.base.mcp.T_start_robot(), before);
  EXPECT_EQ(all.driver.status().state, BaseState::kEmergencyStop);
  all.driver.reset_stop(all.line.now_ns());
  all.pass(2 * kSecond);
  EXPECT_EQ(all.base.mcp.T_start_robot(), before);
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  all.drive(0.4, 0.0, 3 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  EXPECT_LT(all.worst_m, 0.02);
}

TEST_P(BaseSafetyOn, AStartWithThePowerOffIsAnEmergencyStop) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.base.mcp.press_emergency_stop();
  all.drive(0.0, 0.5, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kEmergencyStop);
  all.driver.reset_stop(all.line.now_ns());
  all.drive(0.0, 0.5, 2 * kSecond);  // it is still pressed
  EXPECT_EQ(all.driver.status().state, BaseState::kEmergencyStop);
}

TEST_P(BaseSafetyOn, TheJoystickTakesOverAndIsLeftAlone) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.2, 0.0, 3 * kSecond);
  all.base.mcp.forget_orders();
  for (int i = 0; i < 20; ++i) {  // held against any other command to the base
    all.base.mcp.take_joystick({-0.3, 0.4});
    all.drive(0.2, 0.0, kSecond / 10);
  }
  EXPECT_EQ(all.driver.status().state, BaseState::kJoystick);
  EXPECT_FALSE(all.driver.status().commands_taken);
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kTranslateHalt}));
  all.base.mcp.take_joystick({});
  all.drive(0.2, 0.0, kSecond);
  EXPECT_TRUE(all.base.stands());
  all.pass(3 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
  all.drive(0.2, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
  EXPECT_LT(all.worst_m, 0.02);
}

TEST_P(BaseSafetyOn, AJoystickThatIsSwitchedOffDoesNothing) {
  BaseSettings without = settings();
  without.joystick_allowed = false;
  BaseOnLine all(without);
  ASSERT_TRUE(all.start());
  all.base.mcp.take_joystick({0.3, 0.4});
  all.pass(2 * kSecond);
  EXPECT_TRUE(all.base.stands());
  EXPECT_EQ(all.driver.status().state, BaseState::kReady);
}

TEST_P(BaseSafetyOn, ABumpStopsAndTheWayBackIsFreeToWhoeverNoticed) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.base.mcp.press_bumpers(0x0008, all.line.now_ns());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kBumped);
  EXPECT_EQ(all.driver.status().bumpers, 0x0008);
  EXPECT_FALSE(all.driver.status().commands_taken);
  EXPECT_TRUE(all.base.stands());
  all.drive(0.0, 0.0, kSecond);
  EXPECT_TRUE(all.driver.status().commands_taken);
  all.drive(0.2, 0.0, kSecond);
  EXPECT_TRUE(all.base.stands()) << "it would push";
  all.drive(-0.2, 0.0, kSecond);
  EXPECT_LT(all.base.mcp.commanded_velocity().linear_m_per_s, -0.1);
  EXPECT_EQ(all.driver.status().state, BaseState::kBumped);
  all.base.mcp.press_bumpers(0, all.line.now_ns());
  all.drive(-0.2, 0.0, kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
}

TEST_P(BaseSafetyOn, HaltHoldsUntilReset) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.driver.halt(all.line.now_ns());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kHalted);
  EXPECT_TRUE(all.base.stands());
  all.driver.reset_stop(all.line.now_ns());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
}

TEST_P(BaseSafetyOn, TheEndOfTheDriverIsNoHalt) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.driver.end(all.line.now_ns());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_TRUE(all.base.stands());
  EXPECT_EQ(all.driver.status().state, BaseState::kOffline);
  EXPECT_EQ(all.driver.status().reason, "the gateway ends");
  EXPECT_EQ(all.driver.held_stops(), HeldStops{});
  all.driver.halt(all.line.now_ns());
  EXPECT_EQ(all.driver.status().state, BaseState::kHalted);
  EXPECT_TRUE(all.driver.held_stops().halt);
  all.driver.reset_stop(all.line.now_ns());
  EXPECT_EQ(all.driver.held_stops(), HeldStops{});
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_TRUE(all.base.stands());
}

TEST_P(BaseSafetyOn, AHaltIsOverWhenBothAxesStand) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.5, 2 * kSecond);
  EXPECT_FALSE(all.driver.stands());
  all.base.mcp.forget_orders();
  all.driver.halt(all.line.now_ns());
  EXPECT_FALSE(all.driver.stands());
  EXPECT_EQ(all.driver.status().state, BaseState::kHalted);
  EXPECT_FALSE(all.driver.status().stands) << "it brakes";
  for (int i = 0; i < 200 && !all.driver.stands(); ++i) all.pass(10 * kMs);
  EXPECT_TRUE(all.driver.stands());
  EXPECT_TRUE(all.driver.status().stands);
  EXPECT_TRUE(all.base.stands());
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kTranslateHalt, 0}));
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kRotateHalt, 0}));
}

TEST_P(BaseSafetyOn, AHaltedBaseThatAJoystickMovesDoesNotStand) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.driver.halt(all.line.now_ns());
  all.pass(kSecond);
  EXPECT_TRUE(all.driver.status().stands);
  for (int i = 0; i < 20; ++i) {  // held against any other command to the base
    all.base.mcp.take_joystick({-0.3, 0.4});
    all.pass(kSecond / 10);
  }
  EXPECT_EQ(all.driver.status().state, BaseState::kHalted);
  EXPECT_FALSE(all.driver.status().stands);
  all.base.mcp.take_joystick({});
  all.pass(3 * kSecond);
  EXPECT_TRUE(all.driver.status().stands);
  all.line.unplug();
  all.pass(kSecond);
  EXPECT_FALSE(all.driver.status().stands) << "it is not heard";
}

TEST_P(BaseSafetyOn, AGuardHasTheLastWordOnVelocities) {
  BaseOnLine all(settings());
  double share = 1.0;
  const auto guard = [&share](const BaseVelocity& wanted, std::int64_t) {
    return BaseVelocity{share * wanted.linear_mps, share * wanted.angular_radps};
  };
  all.driver.guard_velocities(guard, 50 * kMs);
  ASSERT_TRUE(all.start());
  const auto speed = [&] { return all.base.mcp.commanded_velocity().linear_m_per_s; };
  all.drive(0.4, 0.2, 2 * kSecond);
  EXPECT_NEAR(speed(), 0.4, 1e-3);
  share = 0.5;
  all.drive(0.4, 0.2, 2 * kSecond);
  EXPECT_NEAR(speed(), 0.2, 1e-3);
  // A valid command is checked again and again.
  (void)all.driver.command(0.4, 0.0, all.line.now_ns() + kSecond / 2, all.line.now_ns());
  share = 0.0;
  all.pass(150 * kMs);
  EXPECT_LT(speed(), 0.17);
  EXPECT_TRUE(all.driver.status().commands_taken);
  share = 1.0;
  all.pass(300 * kMs);
  EXPECT_GT(speed(), 0.17) << "it drives on when the guard lets it";
  all.pass(2 * kSecond);
  EXPECT_TRUE(all.base.stands()) << "but no longer than the command holds";
  all.drive(0.4, 0.0, kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kMoving);
}

TEST_P(BaseSafetyOn, AGuardThatStopsTheBaseLeavesTheBumpToWhoeverCommands) {
  BaseOnLine all(settings());
  all.driver.guard_velocities([](const BaseVelocity&, std::int64_t) { return BaseVelocity{}; },
                              50 * kMs);
  ASSERT_TRUE(all.start());
  all.base.mcp.press_bumpers(0x0008, all.line.now_ns());
  all.drive(0.3, 0.0, 2 * kSecond);
  EXPECT_EQ(all.driver.status().state, BaseState::kBumped);
  EXPECT_FALSE(all.driver.status().commands_taken);
  all.drive(0.0, 0.0, kSecond);
  EXPECT_TRUE(all.driver.status().commands_taken);
}

TEST_P(BaseSafetyOn, AMotorFaultIsSaidAndAcknowledged) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.drive(0.3, 0.0, 2 * kSecond);
  all.base.mcp.forget_orders();
  all.base.mcp.fail_motor(all.line.now_ns());
  all.pass(2 * kSecond);
  EXPECT_THAT(all.base.mcp.orders(), Contains(McpOrder{McpCommand::kAcknowledge, 0}));
  EXPECT_TRUE(all.base.stands());
}

TEST_P(BaseSafetyOn, ALowBatteryIsSaid) {
  BaseOnLine all(settings());
  ASSERT_TRUE(all.start());
  all.pass(kSecond);
  EXPECT_FALSE(all.driver.status().battery_low);
  all.base.mcp.set_battery(43.0, all.line.now_ns());
  all.pass(kSecond);
  EXPECT_TRUE(all.driver.status().battery_low);
  all.pass(11 * kSecond);
  EXPECT_DOUBLE_EQ(all.driver.status().battery_v, 43.0);
}
}  // namespace
}  // namespace topogeo::devices
