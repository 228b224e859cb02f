// Starts a YDLIDAR X2, X4, G4 or TG and returns its scans. An X2 sends as soon as it has power; the
// others are asked for their name and health, then for a scan.
//
// The lasers report no time: beams are timed by the angle and the frequency of the turns, which
// most report and the driver measures otherwise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/rplidar_settings.hpp"
#include "topogeo/devices/turn_clock.hpp"
#include "topogeo/devices/turning_laser_driver.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"
#include "topogeo/devices/ydlidar_packet.hpp"

namespace topogeo::devices {

class YdLidarDriver final : public TurningLaserDriver {
 public:
  /// `motor`: kDtr, kNone, or otherwise as the model needs. Throws std::invalid_argument when a
  /// setting is out of range.
  YdLidarDriver(const LaserModel& model, const TurningLaserSettings& turning, RpMotor motor);

 private:
  void decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void restart() override;
  void interrupt() override;
  [[nodiscard]] std::vector<StartStep> start_steps() const override;
  [[nodiscard]] std::vector<LineOrder> end_orders() const override;
  [[nodiscard]] double turns_hz() const override { return turns_hz_; }
  [[nodiscard]] Drops drops() const override;
  void complete(LaserHealth& health) const override;

  void take_answer(const YdDecoder::Found& found);
  void take(const YdPacket& packet, std::int64_t arrival_ns, std::int64_t now_ns);
  /// Counts a packet that gives no beams, or follows no earlier one.
  void skip(std::uint64_t& count);
  void count_samples(const YdPacket& packet, std::int64_t arrival_ns);
  void add_beams(const YdPacket& packet, std::int64_t last_beam_ns);

  bool asked_;         // the laser obeys requests
  bool triangulates_;  // quarters of a millimetre, and angles to correct
  bool dtr_;           // the signal starts its motor
  YdDecoder decoder_;
  TurnClock clock_;
  std::optional<YdPacket> last_;
  double turns_hz_;
  double step_q6_ = 0.0;     // from sample to sample
  double sample_ns_ = 0.0;   // time of a sample; 0: not known yet
  double counted_ns_ = 0.0;  // of whole turns, and their samples
  double counted_ = 0.0;
  int turns_ = 0;                            // counted
  std::optional<std::size_t> turn_samples_;  // since the packet that started the turn; none: a gap
  std::int64_t turn_began_ns_ = 0;           // arrival of that packet
  std::string device_;
  std::uint8_t status_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t untimed_ = 0;  // packets after a gap, see TurnClock
};

}  // namespace topogeo::devices
