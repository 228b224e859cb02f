// Receives the scans of a LDROBOT LD06, LD08, LD19 or STL-19P. These lasers send as soon as they
// have power and read nothing, so the driver only opens the line and listens.
//
// Each beam is stamped by the laser's own clock, mapped to the host's clock. The manuals do not say
// which beam of a packet the time stamp belongs to; the driver assumes the last one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "topogeo/devices/device_clock.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/devices/turning_laser_driver.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class LdRobotDriver final : public TurningLaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  LdRobotDriver(const LaserModel& model, const TurningLaserSettings& settings);

 private:
  void decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void restart() override;
  void interrupt() override;
  [[nodiscard]] double turns_hz() const override;
  [[nodiscard]] Drops drops() const override;

  void take(const LdPacket& packet, std::int64_t arrival_ns);
  /// Whether `packet` fits the last packet, sent `passed_ms` earlier: speed and angles continue.
  /// Counts a packet that does not fit as implausible.
  [[nodiscard]] bool follows(const LdPacket& packet, std::uint32_t passed_ms);
  void add_beams(const LdPacket& packet, std::int64_t last_beam_ns);

  bool beside_axis_;  // points are not seen from the axis, see ldrobot_optics.hpp
  LdDecoder decoder_;
  DeviceClock clock_;
  std::optional<LdPacket> last_;
  std::int64_t device_ns_ = 0;        // the laser's time without wrapping
  std::int64_t last_arrival_ns_ = 0;  // arrival of the last packet
  std::uint64_t repeated_ = 0;
  std::uint64_t implausible_ = 0;
};

}  // namespace topogeo::devices
