// Starts a Slamtec RPLIDAR, keeps it running and returns its scans: stops what it sends, asks for
// its name and health, starts its motor, then a scan, and begins again after silence.
//
// The protocol has no clock. Where the laser reports the time of a sample, the number of samples
// since the start is its clock, mapped to the host's; otherwise beams are stamped by the arrival of
// their packet.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/device_clock.hpp"
#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/rplidar_decoder.hpp"
#include "topogeo/devices/rplidar_protocol.hpp"
#include "topogeo/devices/rplidar_settings.hpp"
#include "topogeo/devices/turn_assembler.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class RpLidarDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  RpLidarDriver(const LaserModel& model, const TurningLaserSettings& turning,
                const RpLidarSettings& settings);

  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;
  [[nodiscard]] std::vector<LaserScan> take_scans() override;
  [[nodiscard]] LaserHealth health() const override;
  void end(std::int64_t now_ns) override;

 private:
  enum class Step : std::uint8_t {
    kOffline,
    kStop,    ///< waits until the laser has stopped sending
    kInfo,    ///< asks for name and firmware
    kHealth,  ///< asks for its health
    kRate,    ///< asks for the time of a sample
    kSpinUp,  ///< waits for the motor
    kScan,    ///< asks for a scan
    kRun,
    kRest  ///< before the next start
  };
  /// The last packet, whose angles need the next one.
  struct Pending {
    RpPacket packet;
    std::int64_t last_sample_ns = 0;
    std::int64_t sent_ns = 0;
  };

  void start(const std::string& reason, std::int64_t now_ns);
  void ask(Step step, std::int64_t now_ns);
  void fail(const std::string& reason, std::int64_t now_ns);
  void enter(Step step, std::int64_t due_ns);
  void write(std::vector<std::uint8_t> bytes, std::optional<bool> dtr = {});
  /// The request that the motor obeys; none for a motor without requests.
  [[nodiscard]] std::optional<std::uint8_t> motor_command() const;
  void start_motor();
  void request_scan();

  void take(const RpDecoder::Answer& answer, std::int64_t arrival_ns);
  void take_health(std::span<const std::uint8_t> data, std::int64_t now_ns);
  void take_sample(const RpSample& sample, std::int64_t at_ns);
  void take_packet(RpPacket packet, bool contiguous, std::int64_t sent_ns);
  /// Time of a packet's last sample; `sent_ns`: when its first byte left the laser, at the latest.
  [[nodiscard]] std::int64_t time_of(const RpPacket& packet, std::int64_t sent_ns);
  /// Whether a packet is about as wide as the last ones; counts those that are not.
  [[nodiscard]] bool has_usual_width(double width_deg);
  void begin_after_gap();
  void add_packet(const Pending& pending, std::uint16_t next_start_q6);
  void add_beam(double angle_deg, double range_m, std::int64_t at_ns);

  const LaserModel& model_;
  TurningLaserSettings turning_;
  RpLidarSettings settings_;
  LineSettings line_;
  RpDecoder decoder_;
  TurnAssembler turns_;

  Step step_ = Step::kOffline;
  std::int64_t due_ns_ = 0;
  int tries_ = 0;
  int failures_ = 0;
  std::string reason_;
  std::string device_;
  std::uint8_t series_ = 0;
  std::uint8_t error_level_ = 0;
  std::int64_t sample_ns_;
  bool rate_known_ = false;  // sample_ns_ is what the laser reports
  DeviceClock clock_{0};
  std::int64_t device_ns_ = 0;  // time of the last packet by the number of samples
  std::optional<Pending> pending_;
  int doubts_ = 0;              // widths in a row that are not usual
  double last_step_deg_ = 0.0;  // from the start of a packet to that of the next; 0: unknown
  std::int64_t heard_ns_ = 0;   // last samples
  std::uint64_t implausible_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t gaps_ = 0;
  std::uint64_t starts_ = 0;  // that failed
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
