// A SICK nanoScan3, microScan3 or outdoorScan3 on a network: it obeys CoLa 2, and sends data sets
// with the state of a protective and a warning field. It speaks in envelopes
// (devices/envelope.hpp), in which a datagram that is damaged on its way is lost, as in a network.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/envelope.hpp"
#include "topogeo/devices/safety_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct SafetyEmulatorSettings {
  devices::LineSettings line{3'000'000, devices::Parity::kNone};
  std::size_t beams = 1651;
  double first_deg = -47.5;  ///< 90 degrees are ahead
  double view_deg = 275.0;
  double turns_hz = 1000.0 / 30.0;
  double range_max_m = 40.0;
  /// Fields around the laser: cut-off path 1, safe, and 2; 0: not set up.
  double protective_field_m = 0.0;
  double warning_field_m = 0.0;
  std::uint32_t clock_ms = 0;                ///< of the laser at time 0
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power-on to the first answer
  std::int64_t answer_ns = 1'000'000;        ///< from a command to its answer
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class SafetyEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  SafetyEmulator(const SafetyEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  /// The rate of the host does not matter.
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;
  void switch_off() override;
  void set_contaminated(bool contaminated) override {
    status_.contamination_warning = contaminated;
  }
  /// Errors, standby and contamination of the next data sets; the paths follow the fields.
  void set_status(const devices::SafetyState& status) { status_ = status; }
  /// Sends data sets of this channel, whatever was asked for.
  void set_channel(std::uint8_t channel) { channel_ = channel; }
  /// Refuses to change the data output.
  void set_refusing(bool refusing) { refusing_ = refusing; }
  /// Where the datagrams go, as the host asked.
  [[nodiscard]] const devices::SafetyOutput& output() const { return output_; }

 private:
  void send_packet() override;
  void obey(const devices::Cola2Telegram& command, std::int64_t now_ns);
  void say(devices::EnvelopeKind kind, std::span<const std::uint8_t> contents, std::int64_t now_ns);
  void begin_sweep();
  void end_sweep();
  void set_paths();

  SafetyEmulatorSettings settings_;
  devices::Cola2Reader reader_;
  std::int64_t ready_ns_ = 0;  // after power-on
  bool on_ = true;
  bool refusing_ = false;
  std::uint8_t channel_ = 0;
  devices::SafetyOutput output_;
  devices::SafetyState status_;
  devices::SafetyScan scan_;  // of the present sweep
  double step_ns_ = 0.0;
  std::uint32_t sessions_ = 0;
  std::uint32_t scans_ = 0;
};

}  // namespace topogeo::simulation
