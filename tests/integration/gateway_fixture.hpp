// A gateway on the emulated devices of a simulator, and the data that both publish.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/stream.h"
#include "topogeo/support/process_priority.hpp"

#include "program.hpp"

namespace topogeo::test {

class GatewayOnDevices : public testing::Test {
 protected:
  GatewayOnDevices();

  void start_simulator();
  /// Waits for one reader of scans, which is this test. `keys` are additional lines of the file.
  void start_gateway(const std::string& keys = {});
  /// Starts both and waits until the laser runs, the base is ready and `scans` have come.
  void start(std::size_t scans = 5);

  /// Receives messages until `condition` holds.
  template <class Condition>
  bool wait_for(const Condition& condition) {
    return wait_in_loop(loop_, "the gateway and its devices", condition);
  }
  /// The same while sending motion commands ten times a second.
  template <class Condition>
  bool drive_until(double linear_mps, double angular_radps, const Condition& condition) {
    auto next = std::chrono::steady_clock::now();
    return wait_for([&] {
      if (std::chrono::steady_clock::now() >= next) {
        command(linear_mps, angular_radps);
        next = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
      }
      return condition();
    });
  }

  /// The same for a test that wants no stop: on a busy machine a base may stand without a reason
  /// that the gateway sees, which holds it until somebody releases it, as this does.
  template <class Condition>
  bool drive_released_until(double linear_mps, double angular_radps, const Condition& condition) {
    auto next = std::chrono::steady_clock::now();
    return drive_until(linear_mps, angular_radps, [&] {
      if (base_is(msg::kBaseEmergencyStop) && std::chrono::steady_clock::now() >= next) {
        tell_base(msg::kBaseReset);
        next = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
      }
      return condition();
    });
  }

  void command(double linear_mps, double angular_radps);
  void tell_base(msg::BaseCommandKind kind);
  void strike(msg::SimulatedFault fault, msg::SimulatedDevice device, double duration_s);
  /// Waits until all faults have begun.
  bool wait_for_begin();
  /// Lets that time pass in the simulated world, which stops while the machine is busy.
  bool wait_in_world(double duration_s);

  [[nodiscard]] bool base_is(msg::BaseState state) const {
    return base_status_ && base_status_->state() == state;
  }
  [[nodiscard]] bool laser_is(msg::LaserState state) const {
    return laser_status_ && laser_status_->state() == state;
  }
  /// A counter of the gateway's status; 0 if it has none of that name.
  [[nodiscard]] double counter(std::string_view name) const;
  [[nodiscard]] std::uint64_t drops(std::string_view reason) const;

  // Devices and their commands are in real time. This test, simulator and gateway take few per cent
  // of a core.
  const bool goes_first_ = support::go_first();
  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  Scratch scratch_;
  std::string domain_ = own_domain();
  messaging::Participant participant_;
  messaging::Reader<msg::Scan> scans_reader_;
  messaging::Reader<msg::Odometry> odometry_reader_;
  messaging::Reader<msg::BaseStatus> base_reader_;
  messaging::Reader<msg::LaserStatus> laser_reader_;
  messaging::Reader<msg::GroundTruth> truth_reader_;
  messaging::Reader<msg::ServiceStatus> status_reader_;
  messaging::Reader<msg::StreamEnd> end_reader_;
  messaging::Writer<msg::MotionCommand> motion_;
  messaging::Writer<msg::BaseCommand> base_;
  messaging::Writer<msg::SimulatorCommand> faults_;
  messaging::EventLoop loop_;

  std::vector<msg::Scan> scans_;
  std::vector<msg::Odometry> odometry_;
  std::optional<msg::BaseStatus> base_status_;
  std::optional<msg::LaserStatus> laser_status_;
  std::optional<msg::GroundTruth> truth_;
  std::optional<msg::ServiceStatus> gateway_status_;
  std::optional<msg::StreamEnd> end_;
  std::uint64_t commands_ = 0;
  std::optional<std::int64_t> command_stamp_ns_;  ///< empty: now
  int strikes_ = 0;
  std::string laser_port_ = (scratch_ / "laser.port").string();
  std::string laser_model_ = "sick_pls";
  std::filesystem::path memory_;  ///< of the gateway; empty: none
  std::filesystem::path config_;  ///< of gateway and simulator; empty: none

  std::unique_ptr<Program> simulator_;
  std::unique_ptr<Program> gateway_;
};

}  // namespace topogeo::test
