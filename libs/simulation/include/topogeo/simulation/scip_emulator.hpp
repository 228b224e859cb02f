// A Hokuyo laser at the other end of its line: it obeys SCIP 2.0.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/scip_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct ScipEmulatorSettings {
  devices::LineSettings line{3'000'000, devices::Parity::kNone};
  /// The host's rate does not matter: USB, or a network.
  bool any_rate = true;
  devices::ScipParameters sweep{
      "UST-20LX(Hokuyo Automatic Co., Ltd.)", 20, 20'000, 1440, 0, 1080, 540, 2400};
  std::uint32_t clock_ms = 0;                ///< of the laser at time 0
  bool answers_time = true;                  ///< knows the command TM
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power-on to the first answer
  std::int64_t answer_ns = 1'000'000;        ///< from a command to its answer
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class ScipEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  ScipEmulator(const ScipEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;
  void switch_off() override;
  /// The laser reports this status in place of scans; empty: it measures.
  void set_trouble(std::string status) { trouble_ = std::move(status); }

 private:
  void send_packet() override;
  void obey(const std::string& command, std::int64_t now_ns);
  void say(const std::string& text, std::int64_t now_ns);
  void say_fields(const std::string& command, const devices::ScipFields& fields,
                  std::int64_t now_ns);
  /// The command of a scan; empty for another one.
  [[nodiscard]] std::optional<devices::ScipScanRequest> scan_request(
      const std::string& command) const;
  void begin_sweep();
  void end_sweep();
  [[nodiscard]] std::uint32_t clock_ms(std::int64_t now_ns) const;

  ScipEmulatorSettings settings_;
  std::int64_t ready_ns_ = 0;  // after power-on
  bool on_ = true;
  bool asks_time_ = false;  // between TM0 and TM2
  std::string command_;     // characters received of the next one
  std::string echo_;        // of the scans that it sends
  std::optional<devices::ScipScanRequest> request_;
  devices::ScipScan scan_;  // of the present sweep
  unsigned step_ = 0;       // the next one to measure
  double step_ns_ = 0.0;    // time of a step in the present sweep
  std::string trouble_;
};

}  // namespace topogeo::simulation
