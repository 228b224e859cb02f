// Drives a SICK nanoScan3, microScan3 or outdoorScan3 on a network: asks it by CoLa 2 to send its
// data to this host, then takes scans, the state of its fields and its health from the datagrams.
// The port delivers envelopes (envelope.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/device_clock.hpp"
#include "topogeo/devices/envelope.hpp"
#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/safety_protocol.hpp"
#include "topogeo/devices/safety_settings.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class SafetyDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  SafetyDriver(const LaserModel& model, const TurningLaserSettings& turning,
               const SafetySettings& settings);

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
  /// The commands of a start, in order.
  enum class Step : std::uint8_t { kOpen, kConfigure, kScans };

  void start(std::int64_t now_ns);
  void ask(Step step, std::int64_t now_ns);
  void send(char type, char mode, std::vector<std::uint8_t> data);
  void take_host(std::span<const std::uint8_t> text);
  void take(const Cola2Telegram& telegram, std::int64_t now_ns);
  void take(const SafetyScan& scan, std::int64_t now_ns);
  /// False for a scan that does not follow the last one.
  [[nodiscard]] bool follows(const SafetyScan& scan) const;
  /// Whether the scan has the beams that are expected; if not, the reason says so.
  [[nodiscard]] bool fits(const SafetyScan& scan);
  [[nodiscard]] LaserScan to_scan(const SafetyScan& scan, std::int64_t now_ns);
  [[nodiscard]] float range_m(const SafetyScan& scan, const SafetyBeam& beam) const;

  const LaserModel& model_;
  TurningLaserSettings turning_;
  SafetySettings settings_;
  LineSettings line_;
  EnvelopeReader envelopes_;
  Cola2Reader replies_;
  SafetyAssembler assembler_;
  DeviceClock clock_{0};

  LaserState state_ = LaserState::kOffline;
  std::string reason_ = "the port is closed";
  std::string refusal_;  // of the data output by the scanner
  Step step_ = Step::kOpen;
  std::uint32_t session_ = 0;
  std::uint16_t request_ = 0;
  std::uint32_t host_address_ = 0;
  std::uint16_t host_port_ = 0;
  std::int64_t waits_since_ns_ = 0;
  int starts_ = 0;  // in a row without a scan
  bool running_ = false;

  std::uint32_t serial_number_ = 0;
  std::optional<SafetyScan> last_;       // without beams, since the start
  std::optional<std::uint32_t> before_;  // sequence of the last scan before the start
  std::int64_t device_ns_ = 0;           // time of the last scan, without wrapping
  std::int64_t last_stamp_ns_ = 0;
  std::uint64_t silences_ = 0;
  std::uint64_t implausible_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t other_channel_ = 0;
  std::uint64_t other_beams_ = 0;
  std::uint64_t missed_ = 0;
  std::uint64_t refused_ = 0;
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
