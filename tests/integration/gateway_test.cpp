// The gateway on emulated devices: its output, its recovery from faults, and that the base stops
// whenever it must.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/host.hpp"

#include "gateway_fixture.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;

constexpr double kFault_s = 0.4;

TEST_F(GatewayOnDevices, GivesScansAndOdometryInOrderAndSaysWhenItEnds) {
  start(25);
  gateway_->send_signal(SIGTERM);
  ASSERT_TRUE(wait_for([&] { return end_.has_value(); }));
  EXPECT_EQ(gateway_->wait(), 0) << gateway_->err();
  ASSERT_TRUE(wait_for([&] { return scans_.size() >= end_->count(); }));
  EXPECT_EQ(scans_.size(), end_->count());
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    EXPECT_EQ(scans_[i].sequence_number(), i);
    EXPECT_EQ(scans_[i].ranges_m().size(), 361U);
    if (i > 0) {
      EXPECT_GT(scans_[i].stamp_ns(), scans_[i - 1].stamp_ns());
    }
  }
  for (std::size_t i = 1; i < odometry_.size(); ++i) {
    EXPECT_GT(odometry_[i].stamp_ns(), odometry_[i - 1].stamp_ns());
  }
  // A room: most beams of a scan meet something.
  const auto& ranges = scans_.back().ranges_m();
  EXPECT_GT(std::count_if(ranges.begin(), ranges.end(), [](float r) { return r > 0.0F; }), 200);
}

TEST_F(GatewayOnDevices, SaysHowLongScansWaitForOdometry) {
  start_simulator();
  start_gateway("odometry.wait_s: 1\n");
  ASSERT_TRUE(wait_for([&] { return counter("scans_sent") > 25.0; })) << gateway_->err();
  // The base reports at most ten times a second, and some scan between two reports comes shortly
  // after the first.
  EXPECT_TRUE(wait_for([&] { return counter("scan_wait_ms") > 0.0; }));
  EXPECT_GT(counter("scan_latency_ms"), counter("scan_wait_ms"));
  EXPECT_GT(counter("scan_latency_largest_ms"), 30.0);
}

TEST_F(GatewayOnDevices, DrivesAndHaltsWhenCommandsCease) {
  start();
  ASSERT_TRUE(drive_until(
      0.2, 0.0, [&] { return truth_->linear_mps() > 0.15 && base_is(msg::kBaseMoving); }));
  ASSERT_TRUE(wait_for([&] { return truth_->linear_mps() == 0.0 && base_is(msg::kBaseReady); }));
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
}

TEST_F(GatewayOnDevices, EndOfTheGatewayStopsTheBase) {
  start();
  ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
  gateway_->send_signal(SIGTERM);
  EXPECT_TRUE(wait_for([&] { return truth_->linear_mps() == 0.0; }));
  EXPECT_EQ(gateway_->wait(), 0);
  // Turning without driving also ends.
  gateway_.reset();
  base_status_.reset();
  start_gateway();
  ASSERT_TRUE(wait_for([&] { return base_is(msg::kBaseReady) && motion_.matched() > 0; }));
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
  gateway_->send_signal(SIGTERM);
  EXPECT_TRUE(wait_for([&] { return truth_->angular_radps() == 0.0; }));
  EXPECT_EQ(gateway_->wait(), 0);
  // After a gateway that is killed, the base's own watchdog stops it.
  gateway_.reset();
  base_status_.reset();
  start_gateway();
  ASSERT_TRUE(wait_for([&] { return base_is(msg::kBaseReady) && motion_.matched() > 0; }));
  ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
  gateway_->send_signal(SIGKILL);
  EXPECT_TRUE(wait_for([&] { return truth_->linear_mps() == 0.0; }));
}

TEST_F(GatewayOnDevices, HaltHoldsUntilReset) {
  start();
  ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
  tell_base(msg::kBaseHalt);
  ASSERT_TRUE(drive_until(
      0.2, 0.0, [&] { return truth_->linear_mps() == 0.0 && base_is(msg::kBaseHalted); }));
  EXPECT_FALSE(base_status_->commands_taken());
  EXPECT_TRUE(wait_for([&] { return base_status_->stands(); }));
  tell_base(msg::kBaseReset);
  EXPECT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
}

/// After an emergency stop, while motion is commanded.
class GatewayInEmergency : public GatewayOnDevices {
 protected:
  void expect_held_until_reset() {
    // Power is back by then, and the robot must not jump.
    const double back_s = truth_->time_s() + 2.0;
    // A busy machine may take the base for offline now and then.
    ASSERT_TRUE(drive_until(
        0.2, 0.0, [&] { return truth_->time_s() > back_s && base_is(msg::kBaseEmergencyStop); }));
    EXPECT_EQ(truth_->linear_mps(), 0.0);
    tell_base(msg::kBaseReset);
    ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
  }

  void restart_gateway(int signal_number) {
    gateway_->send_signal(signal_number);
    static_cast<void>(gateway_->wait());
    base_status_.reset();
    gateway_.reset();
    start_gateway();
  }
};

TEST_F(GatewayInEmergency, EmergencyStopHoldsUntilResetFiveTimes) {
  start();
  // On a busy machine no scan may be fresh enough for motion while a standing robot is stopped, so
  // it turns first.
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
  for (int i = 0; i < 5; ++i) {
    // On a busy machine the base may report nothing during a whole stop: then the next one counts.
    double next_s = 0.0;
    const bool stopped = drive_until(0.2, 0.0, [&] {
      if (base_is(msg::kBaseEmergencyStop)) return true;
      if (truth_->time_s() < next_s) return false;
      strike(msg::kSimulatedEmergencyStop, msg::kSimulatedBase, 1.5);
      next_s = truth_->time_s() + 3.0;
      return false;
    });
    ASSERT_TRUE(stopped) << i;
    EXPECT_FALSE(base_status_->commands_taken());
    ASSERT_NO_FATAL_FAILURE(expect_held_until_reset()) << i;
  }
}

TEST_F(GatewayInEmergency, StopsHoldOverRestartsOfTheGateway) {
  memory_ = scratch_ / "memory";
  start();
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
  tell_base(msg::kBaseHalt);
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return base_is(msg::kBaseHalted); }));
  for (const int number : {SIGKILL, SIGTERM}) {
    restart_gateway(number);
    ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return base_is(msg::kBaseHalted); })) << number;
    EXPECT_FALSE(base_status_->commands_taken());
    const double later_s = truth_->time_s() + 1.0;
    ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->time_s() > later_s; }));
    EXPECT_EQ(truth_->angular_radps(), 0.0);
  }
  // The killed gateway may still count as a reader, so one reset may be lost.
  auto next = std::chrono::steady_clock::now();
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] {
    if (base_is(msg::kBaseHalted) && std::chrono::steady_clock::now() >= next) {
      tell_base(msg::kBaseReset);
      next = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
    }
    return truth_->angular_radps() > 0.3;
  }));
  // The gateway halts the base when it ends, which is no stop that holds.
  restart_gateway(SIGTERM);
  ASSERT_TRUE(wait_for([&] { return base_is(msg::kBaseReady); })) << gateway_->err();
}

/// The robot is still moving: power is back before its wheels have stopped.
TEST_F(GatewayInEmergency, AShortEmergencyStopHoldsUntilResetToo) {
  start();
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.19; })) << i;
    // A stop that comes while a busy machine takes the base for offline may be missed.
    double struck_s = -1e9;
    ASSERT_TRUE(drive_until(0.2, 0.0, [&] {
      if (truth_->time_s() > struck_s + 5.0 && truth_->linear_mps() > 0.19) {
        strike(msg::kSimulatedEmergencyStop, msg::kSimulatedBase, 0.3);
        struck_s = truth_->time_s();
      }
      return base_is(msg::kBaseEmergencyStop);
    })) << i;
    ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() == 0.0; })) << i;
    ASSERT_NO_FATAL_FAILURE(expect_held_until_reset()) << i;
  }
}

TEST_F(GatewayOnDevices, NoProgramDrivesIntoWhatTheLaserSees) {
  start();
  // A busy machine also stops it for want of a fresh scan.
  ASSERT_TRUE(drive_until(0.5, 0.0, [&] {
    return gateway_->err().find("into what the laser sees") != std::string::npos &&
           counter("last_guard_stops") > 0.0 && truth_->linear_mps() == 0.0;
  })) << gateway_->err();
  EXPECT_EQ(truth_->collisions(), 0U);
  EXPECT_LT(truth_->free_ahead_m(), 0.3);
  EXPECT_TRUE(base_status_->commands_taken());
  EXPECT_TRUE(drive_until(0.0, 0.5, [&] { return truth_->angular_radps() > 0.3; }));
}

TEST_F(GatewayOnDevices, NoProgramTurnsABaseMoreTightlyThanItCan) {
  constexpr double kRadius_m = 0.8;
  config_ = scratch_ / "car.yaml";
  std::ofstream(config_) << "base.minimum_turning_radius_m: " << kRadius_m << '\n';
  start();
  ASSERT_TRUE(drive_until(0.0, 0.5, [&] { return counter("too_tight_turns") > 0.0; }))
      << gateway_->err();
  EXPECT_EQ(truth_->angular_radps(), 0.0);
  bool drivable = true;
  ASSERT_TRUE(drive_until(0.2, 1.0, [&] {
    drivable = drivable && truth_->angular_radps() * kRadius_m <= truth_->linear_mps() + 1e-6;
    return truth_->linear_mps() > 0.15 && truth_->angular_radps() > 0.15;
  })) << gateway_->err();
  EXPECT_TRUE(drivable);
}

TEST_F(GatewayOnDevices, ACommandThatIsOldByItsStampMovesNothing) {
  start();
  command_stamp_ns_ = support::wall_clock_ns() - 10'000'000'000;
  ASSERT_TRUE(drive_until(0.2, 0.0, [&] { return drops("old command") > 5; })) << gateway_->err();
  EXPECT_EQ(truth_->linear_mps(), 0.0);
  command_stamp_ns_.reset();
  EXPECT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
}

TEST_F(GatewayOnDevices, JoystickIsSeenAndLetGo) {
  start();
  strike(msg::kSimulatedJoystick, msg::kSimulatedBase, 10.0);
  ASSERT_TRUE(wait_for([&] { return base_is(msg::kBaseJoystick); })) << gateway_->err();
  EXPECT_FALSE(base_status_->commands_taken());
  ASSERT_TRUE(wait_for([&] { return base_is(msg::kBaseReady); })) << gateway_->err();
  EXPECT_EQ(truth_->linear_mps(), 0.0);
  EXPECT_TRUE(drive_until(0.2, 0.0, [&] { return truth_->linear_mps() > 0.15; }));
}

/// The base forgets its counters and settings without power, but the odometry continues.
TEST_F(GatewayOnDevices, OdometryOutlivesRestartsOfTheBase) {
  start();
  const auto stands = [&] { return truth_->linear_mps() == 0.0 && base_is(msg::kBaseReady); };
  // Waits for samples that were measured after the robot stopped.
  const auto settle = [&] {
    const std::size_t samples = odometry_.size();
    return drive_released_until(0.0, 0.0,
                                [&] { return stands() && odometry_.size() >= samples + 5; });
  };
  ASSERT_TRUE(settle());
  const geometry::Pose2 T_world_start = service::from_msg(truth_->T_world_robot());
  const geometry::Pose2 T_odom_start = service::from_msg(odometry_.back().T_odom_robot());
  for (int i = 1; i <= 3; ++i) {
    // Late commands may have brought it to a wall, where the gateway lets it go no further.
    ASSERT_TRUE(drive_released_until(0.0, 0.5, [&] { return truth_->free_ahead_m() > 1.5; }));
    const geometry::Pose2 T_world_before = service::from_msg(truth_->T_world_robot());
    ASSERT_TRUE(drive_released_until(0.3, 0.0, [&] {
      const geometry::Pose2 T_world_now = service::from_msg(truth_->T_world_robot());
      return geometry::between(T_world_before, T_world_now).position_m().norm() > 0.3;
    }));
    ASSERT_TRUE(settle());
    strike(msg::kSimulatedRestart, msg::kSimulatedBase, kFault_s);
    ASSERT_TRUE(wait_for([&] { return counter("base_restarts") >= i; })) << gateway_->err();
    ASSERT_TRUE(settle());
    const geometry::Pose2 truth =
        geometry::between(T_world_start, service::from_msg(truth_->T_world_robot()));
    const geometry::Pose2 reported =
        geometry::between(T_odom_start, service::from_msg(odometry_.back().T_odom_robot()));
    // 5 cm on the three drives of 0.3 m, and in proportion when late commands make them longer.
    const double driven_m = std::max(0.9, truth.position_m().norm());
    EXPECT_LT((truth.position_m() - reported.position_m()).norm(), 0.05 / 0.9 * driven_m) << i;
  }
}

struct FaultCase {
  const char* name;
  msg::SimulatedFault fault;
  msg::SimulatedDevice device;
};

// Without it a test's name would hold the address of the name.
std::ostream& operator<<(std::ostream& out, const FaultCase& fault) {
  return out << fault.name;
}

class GatewayFaults : public GatewayOnDevices, public testing::WithParamInterface<FaultCase> {};

/// Five times: the fault begins and ends, and the device's data comes again, measured after the
/// end.
TEST_P(GatewayFaults, ComesBackFiveTimes) {
  start();
  const bool laser = GetParam().device == msg::kSimulatedLaser;
  for (int i = 0; i < 5; ++i) {
    strike(GetParam().fault, GetParam().device, kFault_s);
    ASSERT_TRUE(wait_for_begin() && wait_in_world(kFault_s));
    const std::size_t scans = scans_.size();
    const std::size_t samples = odometry_.size();
    ASSERT_TRUE(wait_for([&] {
      return laser ? laser_is(msg::kLaserRunning) && scans_.size() >= scans + 5
                   : base_is(msg::kBaseReady) && odometry_.size() >= samples + 5;
    })) << GetParam().name
        << ' ' << i << '\n'
        << gateway_->err();
  }
  for (std::size_t i = 1; i < scans_.size(); ++i) {
    EXPECT_EQ(scans_[i].sequence_number(), scans_[i - 1].sequence_number() + 1);
    EXPECT_GT(scans_[i].stamp_ns(), scans_[i - 1].stamp_ns());
    EXPECT_EQ(scans_[i].ranges_m().size(), 361U);
  }
  if (GetParam().fault == msg::kSimulatedUnplug) {
    EXPECT_TRUE(
        wait_for([&] { return counter(laser ? "laser_port_opened" : "base_port_opened") >= 6.0; }));
  }
  gateway_->send_signal(SIGTERM);
  EXPECT_EQ(gateway_->wait(), 0) << gateway_->err();
}

INSTANTIATE_TEST_SUITE_P(
    All, GatewayFaults,
    testing::Values(FaultCase{"laser_bad_crc", msg::kSimulatedBadCrc, msg::kSimulatedLaser},
                    FaultCase{"laser_truncated", msg::kSimulatedTruncated, msg::kSimulatedLaser},
                    FaultCase{"laser_silence", msg::kSimulatedSilence, msg::kSimulatedLaser},
                    FaultCase{"laser_garbage", msg::kSimulatedGarbage, msg::kSimulatedLaser},
                    FaultCase{"laser_unplug", msg::kSimulatedUnplug, msg::kSimulatedLaser},
                    FaultCase{"laser_restart", msg::kSimulatedRestart, msg::kSimulatedLaser},
                    FaultCase{"laser_stuck", msg::kSimulatedStuckScan, msg::kSimulatedLaser},
                    FaultCase{"base_bad_crc", msg::kSimulatedBadCrc, msg::kSimulatedBase},
                    FaultCase{"base_joystick", msg::kSimulatedJoystick, msg::kSimulatedBase},
                    FaultCase{"base_truncated", msg::kSimulatedTruncated, msg::kSimulatedBase},
                    FaultCase{"base_silence", msg::kSimulatedSilence, msg::kSimulatedBase},
                    FaultCase{"base_garbage", msg::kSimulatedGarbage, msg::kSimulatedBase},
                    FaultCase{"base_unplug", msg::kSimulatedUnplug, msg::kSimulatedBase},
                    FaultCase{"base_restart", msg::kSimulatedRestart, msg::kSimulatedBase},
                    FaultCase{"base_echo", msg::kSimulatedEcho, msg::kSimulatedBase}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(GatewayOnDevices, DropsAreCountedByReason) {
  start();
  strike(msg::kSimulatedBadCrc, msg::kSimulatedLaser, 1.0);
  EXPECT_TRUE(wait_for([&] { return drops("bad checksum") > 0; }));
  EXPECT_TRUE(wait_for([&] { return !laser_status_->drops().empty(); }));
}

TEST_F(GatewayOnDevices, SaysWhichPortItMisses) {
  start_gateway();  // no simulator
  ASSERT_TRUE(wait_for([&] { return laser_status_ && base_status_; }));
  ASSERT_TRUE(wait_for([&] {
    return std::string(laser_status_->reason().c_str()).find("laser.port") != std::string::npos;
  }));
  EXPECT_TRUE(laser_is(msg::kLaserOffline));
  EXPECT_TRUE(base_is(msg::kBaseOffline));
  EXPECT_THAT(std::string(base_status_->reason().c_str()), HasSubstr("base.port"));
  gateway_->send_signal(SIGTERM);
  EXPECT_EQ(gateway_->wait(), 0);
}

/// Exit code and message of a gateway that cannot start.
class GatewayMistakes : public testing::Test {
 protected:
  std::string error_for(const std::string& text) {
    const std::filesystem::path file = scratch_ / "devices.yaml";
    std::ofstream(file) << text;
    Program gateway(scratch_, "sensor_gateway",
                    {"--domain", own_domain(), "--devices", file.string()});
    EXPECT_EQ(gateway.wait(), 2);
    return gateway.err();
  }
  Scratch scratch_;
};

TEST_F(GatewayMistakes, FileOfDevicesIsChecked) {
  EXPECT_THAT(error_for("laser:\n  prt: /dev/ttyS0\n"),
              HasSubstr("devices.yaml:2: key 'laser.prt'"));
  EXPECT_THAT(error_for("laser:\n  baud: fast\n"), HasSubstr("'laser.baud' = 'fast'"));
  EXPECT_THAT(error_for("laser:\n  port: /dev/x\n  baud: 9601\n"), HasSubstr("9601"));
  EXPECT_THAT(error_for("laser:\n  port: /dev/x\n  detection_bauds: \"9600 slow\"\n"),
              HasSubstr("laser.detection_bauds"));
  EXPECT_THAT(error_for("laser:\n  port: /dev/x\nbase:\n  port: /dev/x\n"),
              HasSubstr("another port"));
  EXPECT_THAT(error_for("laser:\n  baud: 9600\n"), HasSubstr("at least one port"));
}

}  // namespace
}  // namespace topogeo::test
