// A ROBOTIS LDS-01 or the laser of a Neato XV-11 at the other end of a serial line: packets of a
// few degrees each. The LDS-01 turns after the letter b, until e.
#pragma once

#include <cstdint>
#include <span>

#include "topogeo/devices/lds_packet.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct LdsEmulatorSettings {
  devices::LdsFormat format = devices::kXv11;
  devices::LineSettings line{115'200, devices::Parity::kNone};
  bool waits_for_letter = false;  ///< it turns after b; otherwise as long as it has power
  double turns_hz = 5.0;          ///< mean; (0, 100]
  double wobble = 0.02;           ///< largest relative error of the speed; [0, 1)
  double range_max_m = 6.0;
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power or letter to the first packet
  bool wrong_checksums = false;  ///< its checksums follow another rule than that of the XV-11
  std::uint64_t seed = 1;        ///< of the places of faults
};

class LdsEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  LdsEmulator(const LdsEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void switch_off() override;
  void switch_on(std::int64_t now_ns) override;
  [[nodiscard]] bool turns() const { return next_ns() != kNever_ns; }

 private:
  void send_packet() override;

  LdsEmulatorSettings settings_;
  bool off_ = false;
  std::size_t number_ = 0;  // of the next packet
};

}  // namespace topogeo::simulation
