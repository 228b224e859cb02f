// A driver of a base with two wheels and the emulator of its family at the ends of a line; the
// wheels move as the motors want. And faults that strike such a line while the robot drives.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/support/random.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {

constexpr std::int64_t kWheelsMs_ns = 1'000'000;
constexpr std::int64_t kWheelsSecond_ns = 1000 * kWheelsMs_ns;

template <typename Driver, typename Emulator>
struct TwoWheelsOnLine {
  template <typename EmulatorSettings>
  TwoWheelsOnLine(const BaseSettings& settings, const EmulatorSettings& base)
      : driver(settings), emulator(base), line(driver, emulator), host(settings.line) {}

  void pass(std::int64_t duration_ns) {
    constexpr std::int64_t kStep_ns = 5 * kWheelsMs_ns;
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
    for (std::int64_t passed_ns = 0; passed_ns < duration_ns; passed_ns += 100 * kWheelsMs_ns) {
      taken = driver.command(linear_mps, angular_radps, line.now_ns() + 500 * kWheelsMs_ns,
                             line.now_ns());
      pass(100 * kWheelsMs_ns);
    }
  }
  bool start() {
    line.plug_in();
    return wait_for_commands();
  }
  bool wait_for_commands() {
    for (int i = 0; i < 50 && !driver.status().commands_taken; ++i) pass(100 * kWheelsMs_ns);
    return driver.status().commands_taken;
  }
  /// The base stops without the driver: by itself, or by who watches over the driver.
  void pass_without_driver(std::int64_t duration_ns) {
    pass(300 * kWheelsMs_ns);
    const std::vector<std::uint8_t> stop = driver.stop_bytes();
    if (!stop.empty()) emulator.receive(stop, host, line.now_ns());
    pass(duration_ns);
  }
  [[nodiscard]] double speed_mps() const { return emulator.commanded_velocity().linear_m_per_s; }
  void expect_pose(double within_m) const {
    EXPECT_LT((last.T_odom_robot.position_m() - truth.position_m()).norm(), within_m);
    EXPECT_NEAR(geometry::wrap_angle(last.T_odom_robot.theta_rad - truth.theta_rad), 0.0, 0.02);
  }

  Driver driver;
  Emulator emulator;
  SimulatedLine line;
  LineSettings host;
  BaseOdometry last{.stamp_ns = std::numeric_limits<std::int64_t>::min()};
  geometry::Pose2 truth;
  double fastest_mps = 0.0;
  bool taken = false;
};

/// Its last pose, speed, battery and drops are those of a base that drove as told.
template <typename OnLine>
void drive_a_square(OnLine& base, double battery_v) {
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  for (int side = 0; side < 4; ++side) {
    base.drive(0.3, 0.0, 3 * kWheelsSecond_ns);
    base.drive(0.0, 0.5, 3 * kWheelsSecond_ns);
  }
  base.drive(0.0, 0.0, 2 * kWheelsSecond_ns);
  base.expect_pose(0.02);
  EXPECT_LE(base.fastest_mps, 0.31);
  EXPECT_TRUE(base.driver.stands());
  EXPECT_NEAR(base.driver.status().battery_v, battery_v, 1e-9);
  EXPECT_FALSE(base.driver.status().battery_low);
  for (const std::uint64_t drops : base.driver.status().drops) EXPECT_EQ(drops, 0U);
}

/// The guard of a gateway judges the arc that is commanded: the base gets no other one.
template <typename OnLine>
void keep_the_arc_of_fast_commands(OnLine& base) {
  ASSERT_TRUE(base.start());
  const BaseLimits& most = base.driver.limits();
  const geometry::Velocity arc{most.linear_mps, 10.0 * most.angular_radps};
  base.drive(arc.linear_m_per_s, arc.angular_rad_per_s, 3 * kWheelsSecond_ns);
  EXPECT_NEAR(base.emulator.commanded_velocity().linear_m_per_s, 0.1 * most.linear_mps, 0.005);
  EXPECT_NEAR(base.emulator.commanded_velocity().angular_rad_per_s, most.angular_radps, 0.02);
  base.drive(1e300, 1e-300, 3 * kWheelsSecond_ns);
  EXPECT_NEAR(base.emulator.commanded_velocity().linear_m_per_s, most.linear_mps, 0.005);
  EXPECT_NEAR(base.emulator.commanded_velocity().angular_rad_per_s, 0.0, 0.02);
}

/// A press straight ahead, which its `bumpers` show, stops the base: it may drive back but not on.
template <typename OnLine>
void back_off_from_a_bump(OnLine& base, unsigned bumpers) {
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.emulator.press_bumpers(1, base.line.now_ns());
  base.drive(0.3, 0.0, 500 * kWheelsMs_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_EQ(base.driver.status().state, BaseState::kBumped);
  EXPECT_EQ(base.driver.status().bumpers, bumpers);
  base.pass(kWheelsSecond_ns);
  base.drive(0.3, 0.0, 300 * kWheelsMs_ns);
  EXPECT_FALSE(base.taken) << "not further into the obstacle";
  base.pass(kWheelsSecond_ns);
  base.drive(-0.2, 0.0, 500 * kWheelsMs_ns);
  EXPECT_TRUE(base.taken);
}

/// Its power goes and comes back between two drives.
template <typename OnLine>
void restart_on_the_way(OnLine& base, std::int64_t back_after_ns) {
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, 3 * kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.emulator.switch_on(base.line.now_ns());
  base.pass(back_after_ns);
  ASSERT_TRUE(base.driver.status().commands_taken) << base.driver.status().reason;
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.drive(0.0, 0.0, kWheelsSecond_ns);
  base.expect_pose(0.03);
}

/// A base without a watchdog, whose program was killed and started again.
template <typename OnLine>
void run_on_from_a_killed_program(OnLine& base) {
  ASSERT_TRUE(base.start());
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  base.line.unplug();
  base.pass(2 * kWheelsSecond_ns);
  EXPECT_GT(base.speed_mps(), 0.2) << "it obeys its last speeds for ever";
  base.line.plug_in();
  base.pass(300 * kWheelsMs_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  EXPECT_TRUE(base.driver.status().commands_taken);
  EXPECT_EQ(base.driver.status().restarts, 0U);
  base.expect_pose(0.02);
}

/// A command alone moves nothing once the reason of an emergency stop has gone, only one after a
/// reset does.
template <typename OnLine>
void expect_reset_before_motion(OnLine& base) {
  EXPECT_EQ(base.speed_mps(), 0.0) << "a command alone moves nothing";
  base.driver.reset_stop(base.line.now_ns());
  base.pass(kWheelsSecond_ns);
  EXPECT_EQ(base.speed_mps(), 0.0);
  base.drive(0.3, 0.0, kWheelsSecond_ns);
  EXPECT_GT(base.speed_mps(), 0.1);
}

template <typename Driver>
void expect_settings_refused(const BaseSettings& good,
                             const std::vector<std::function<void(BaseSettings&)>>& changes) {
  for (const auto& change : changes) {
    BaseSettings settings = good;
    change(settings);
    EXPECT_THROW(Driver{settings}, std::invalid_argument);
  }
}

template <typename OnLine>
struct TwoWheelFault {
  const char* name;
  std::function<void(OnLine&, std::int64_t)> inject;  ///< for a time
};

template <typename OnLine>
std::vector<TwoWheelFault<OnLine>> two_wheel_faults() {
  const auto with = [](simulation::BaseFault fault) {
    return [fault](OnLine& base, std::int64_t time_ns) {
      base.emulator.set_fault(fault, true);
      base.pass(time_ns);
      base.emulator.set_fault(fault, false);
    };
  };
  return {{"Corrupted", with(simulation::BaseFault::kCorrupted)},
          {"Truncated", with(simulation::BaseFault::kTruncated)},
          {"Silent", with(simulation::BaseFault::kSilent)},
          {"Noise",
           [](OnLine& base, std::int64_t time_ns) {
             base.emulator.send_garbage(static_cast<std::size_t>(time_ns / kWheelsMs_ns),
                                        base.line.now_ns());
             base.pass(time_ns);
           }},
          {"Doubled",
           [](OnLine& base, std::int64_t time_ns) {
             base.line.set_filter([](std::vector<std::uint8_t>& bytes) {
               bytes.insert(bytes.end(), bytes.begin(), bytes.end());
             });
             base.pass(time_ns);
             base.line.set_filter({});
           }},
          {"Unplugged",
           [](OnLine& base, std::int64_t time_ns) {
             base.line.unplug();
             base.pass(time_ns + 400 * kWheelsMs_ns);
             if (base.driver.stop_bytes().empty()) {
               EXPECT_EQ(base.speed_mps(), 0.0) << "the base stops by itself";
             }
             base.line.plug_in();
           }},
          {"Restarted",
           [](OnLine& base, std::int64_t time_ns) {
             base.emulator.switch_on(base.line.now_ns());
             base.pass(time_ns);
           }},
          {"HostFrozen", [](OnLine& base, std::int64_t time_ns) {
             base.line.freeze_host(true);
             base.pass_without_driver(time_ns + 200 * kWheelsMs_ns);
             EXPECT_EQ(base.speed_mps(), 0.0) << "the base stops without the driver";
             base.line.freeze_host(false);
           }}};
}

/// Whatever strikes while the robot drives, its base stands within its braking once nobody commands
/// it, no odometry jumps, and it drives again. `lag_m`: how far the base drives until its last
/// report arrives.
template <typename OnLine>
void strike_a_thousand_times(OnLine& base, const TwoWheelFault<OnLine>& fault,
                             double lag_m = 0.02) {
  support::Random random(5);
  ASSERT_TRUE(base.start()) << base.driver.status().reason;
  std::size_t moving = 0;
  std::size_t jumps = 0;
  std::size_t lame = 0;
  for (int time = 0; time < 1000; ++time) {
    base.drive(0.3, random.below(2) == 0 ? 0.0 : 0.3, 300 * kWheelsMs_ns);
    const geometry::Pose2 before = base.last.T_odom_robot;
    const geometry::Pose2 true_before = base.truth;
    fault.inject(base, kWheelsMs_ns * static_cast<std::int64_t>(5 + random.below(400)));
    base.pass(700 * kWheelsMs_ns);
    if (base.speed_mps() != 0.0) ++moving;
    // A base that restarted counts anew, so what it drove unheard is missing, but nothing is added.
    const double shown_m = geometry::between(before, base.last.T_odom_robot).position_m().norm();
    const double true_m = geometry::between(true_before, base.truth).position_m().norm();
    if (shown_m > true_m + lag_m) ++jumps;
    base.wait_for_commands();
    base.drive(0.1, 0.0, 200 * kWheelsMs_ns);
    if (!base.taken) ++lame;
  }
  EXPECT_EQ(moving, 0U);
  EXPECT_EQ(jumps, 0U);
  EXPECT_EQ(lame, 0U);
}

}  // namespace topogeo::devices
