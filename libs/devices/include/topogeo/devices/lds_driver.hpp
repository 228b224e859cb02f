// Receives the scans of a ROBOTIS LDS-01 or the laser of a Neato XV-11. The LDS-01 turns after the
// letter b and stops after e; the motor of the XV-11 hangs on a controller of its own.
//
// The lasers report no time: beams are timed by the angle and the speed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/lds_packet.hpp"
#include "topogeo/devices/lds_settings.hpp"
#include "topogeo/devices/turn_clock.hpp"
#include "topogeo/devices/turning_laser_driver.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class LdsDriver final : public TurningLaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  LdsDriver(const LaserModel& model, const TurningLaserSettings& turning,
            const LdsSettings& settings);

 private:
  void decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void restart() override;
  void interrupt() override;
  [[nodiscard]] std::vector<StartStep> start_steps() const override;
  [[nodiscard]] std::vector<LineOrder> end_orders() const override;
  [[nodiscard]] double turns_hz() const override;
  [[nodiscard]] Drops drops() const override;
  void complete(LaserHealth& health) const override;

  void take(const LdsPacket& packet, std::int64_t arrival_ns, std::int64_t now_ns);
  void add_beams(const LdsPacket& packet, std::int64_t last_beam_ns);

  const LdsFormat& format_;
  LdsDecoder decoder_;
  TurnClock clock_;
  std::optional<LdsPacket> last_;
  std::uint64_t repeated_ = 0;
  std::uint64_t untimed_ = 0;   // packets after a gap, see TurnClock
  std::uint64_t unsteady_ = 0;  // packets with a speed unlike the last one
};

}  // namespace topogeo::devices
