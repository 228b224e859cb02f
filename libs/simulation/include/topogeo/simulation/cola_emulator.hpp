// A SICK TiM or LMS1xx at the other end of a network connection: it obeys CoLa A or CoLa B.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/cola_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct ColaEmulatorSettings {
  devices::LineSettings line{3'000'000, devices::Parity::kNone};
  devices::ColaDialect dialect = devices::ColaDialect::kText;
  std::string name = "TiM571";
  std::size_t beams = 811;
  double first_deg = -45.0;  ///< 90 degrees are ahead
  double step_deg = 0.3333;
  double turns_hz = 15.0;
  double range_max_m = 25.0;
  std::uint32_t clock_us = 0;                ///< of the laser at time 0
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power-on to the first answer
  std::int64_t answer_ns = 1'000'000;        ///< from a command to its answer
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class ColaEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  ColaEmulator(const ColaEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  /// The rate of the host does not matter.
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;
  void switch_off() override;
  /// See devices::ColaScan::status.
  void set_status(std::uint8_t status) { status_ = status; }

 private:
  void send_packet() override;
  void obey(const devices::ColaTelegram& command, std::int64_t now_ns);
  void say(const devices::ColaTelegram& telegram, std::int64_t now_ns);
  void begin_sweep();
  [[nodiscard]] std::uint32_t clock_us(std::int64_t now_ns) const;

  ColaEmulatorSettings settings_;
  devices::ColaReader reader_;
  std::int64_t ready_ns_ = 0;  // after power-on
  bool on_ = true;
  std::uint8_t status_ = 0;
  devices::ColaScan scan_;  // of the present sweep
  double step_ns_ = 0.0;
  std::uint16_t scans_ = 0;
};

}  // namespace topogeo::simulation
