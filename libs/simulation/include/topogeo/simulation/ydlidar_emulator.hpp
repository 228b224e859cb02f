// A YDLIDAR at the other end of a serial line: packets of up to 40 samples, after a packet of one
// that starts each turn. An X2 sends as soon as it has power, the others after a request.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct YdLidarEmulatorSettings {
  devices::LineSettings line{512'000, devices::Parity::kNone};
  bool asked = true;          ///< it sends after a request; otherwise as long as it has power
  bool triangulates = false;  ///< quarters of a millimetre, with angles to correct
  bool reports_frequency = true;
  double turns_hz = 10.0;  ///< mean; (0, 100]
  double samples_hz = 20'000.0;
  double wobble = 0.02;  ///< largest relative error of the speed; [0, 1)
  double range_max_m = 30.0;
  std::uint8_t model = 100;                  ///< that it reports
  std::uint8_t health = 0;                   ///< 0 good, 1 warning, 2 error
  std::int64_t answer_ns = 2'000'000;        ///< from a request to its answer
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power-on until it obeys or sends
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class YdLidarEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  YdLidarEmulator(const YdLidarEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void switch_off() override;
  void switch_on(std::int64_t now_ns) override;
  [[nodiscard]] bool scans() const { return next_ns() != kNever_ns; }

 private:
  void send_packet() override;
  void obey(std::uint8_t command, std::int64_t now_ns);

  YdLidarEmulatorSettings settings_;
  std::vector<std::uint8_t> request_;
  std::int64_t ready_ns_ = 0;  // end of the start-up
  bool off_ = false;
  bool turned_ = true;      // the next packet starts a turn
  double angle_deg_ = 0.0;  // of the next sample, clockwise
};

}  // namespace topogeo::simulation
