// Receives the scans of a LDROBOT LD06, LD19 or STL-19P. These lasers send as soon as they have
// power and read nothing, so the driver only opens the line and listens.
//
// The time of each beam is that of the laser's own clock, mapped to the host's. The manuals do not
// say which moment of a packet the time stamp belongs to; the driver takes it for that of the last
// beam.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/devices/turn_assembler.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class LdRobotDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  LdRobotDriver(const LaserModel& model, const TurningLaserSettings& settings);

  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;
  [[nodiscard]] std::vector<LaserScan> take_scans() override;
  [[nodiscard]] LaserHealth health() const override;

 private:
  void take(const LdPacket& packet, std::int64_t arrival_ns);
  /// Whether the laser can have sent `packet` so long after the last one; counts why not.
  [[nodiscard]] bool follows(const LdPacket& packet, std::uint32_t passed_ms);
  void add_beams(const LdPacket& packet, std::int64_t last_beam_ns);
  void wait(LaserState state, std::string reason);

  const LaserModel& model_;
  TurningLaserSettings settings_;
  LineSettings line_;
  LdDecoder decoder_;
  TurnAssembler turns_;
  DeviceClock clock_;

  LaserState state_ = LaserState::kOffline;
  std::string reason_;
  std::optional<LdPacket> last_;
  std::int64_t device_ns_ = 0;        // the laser's time without wrapping
  std::int64_t last_arrival_ns_ = 0;  // of a packet
  std::int64_t waits_since_ns_ = 0;   // for a packet
  std::int64_t last_byte_ns_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t implausible_ = 0;
  std::uint64_t silences_ = 0;
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
