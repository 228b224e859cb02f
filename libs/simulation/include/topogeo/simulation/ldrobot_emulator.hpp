// A LDROBOT LD06, LD08, LD19 or STL-19P at the other end of a serial line: it sends packets of
// twelve points as long as it has power. Its speed varies, so that turns differ in their number of
// points.
#pragma once

#include <cstdint>
#include <span>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/turning_emulator.hpp"

namespace topogeo::simulation {

struct LdRobotEmulatorSettings {
  devices::LineSettings line{230'400, devices::Parity::kNone};
  double turns_hz = 10.0;      ///< mean; (0, 100]
  double samples_hz = 4500.0;  ///< measurements a second, > 0
  double wobble = 0.02;        ///< largest relative error of the speed; [0, 1)
  double range_max_m = 12.0;
  bool beside_axis = false;                  ///< it looks past its axis, as an LD08 does
  std::int64_t start_up_ns = 1'000'000'000;  ///< from power-on to the first packet
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class LdRobotEmulator final : public TurningEmulator {
 public:
  /// A laser that was switched on long before `now_ns`. Throws std::invalid_argument for invalid
  /// settings.
  LdRobotEmulator(const LdRobotEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns = 0);

  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;

 private:
  void send_packet() override;

  LdRobotEmulatorSettings settings_;
  double angle_deg_ = 0.0;  // of the next packet's first point, clockwise
};

}  // namespace topogeo::simulation
