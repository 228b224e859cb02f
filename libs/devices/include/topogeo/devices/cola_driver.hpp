// Drives a SICK TiM or LMS1xx on a network: requests its name, starts the measurement and receives
// its scans. The driver changes no setting of the laser.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/cola_protocol.hpp"
#include "topogeo/devices/cola_settings.hpp"
#include "topogeo/devices/device_clock.hpp"
#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class ColaDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  ColaDriver(const LaserModel& model, const TurningLaserSettings& turning,
             const ColaSettings& settings);

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
  /// Commands that start the laser, in order.
  enum class Step : std::uint8_t {
    kName,
    kLogIn,    ///< gives the right to send the next two
    kMeasure,  ///< starts the motor of an LMS1xx in standby
    kRun,      ///< logs out
    kScans     ///< subscribes to all scans
  };

  void start(std::int64_t now_ns);
  void ask(Step step, std::int64_t now_ns);
  [[nodiscard]] ColaTelegram command_of(Step step) const;
  void take(const ColaTelegram& telegram, std::int64_t now_ns);
  void take_scan(const ColaTelegram& telegram, std::int64_t now_ns);
  /// Whether the start time of `scan` continues that of the last scan.
  [[nodiscard]] bool follows(const ColaScan& scan) const;
  [[nodiscard]] LaserScan to_scan(const ColaScan& scan, std::int64_t now_ns);
  [[nodiscard]] float range_m(float measured_m) const;

  const LaserModel& model_;
  TurningLaserSettings turning_;
  ColaSettings settings_;
  LineSettings line_;
  ColaReader reader_;
  DeviceClock clock_{0};

  LaserState state_ = LaserState::kOffline;
  std::string reason_ = "the port is closed";
  Step step_ = Step::kName;
  ColaDialect dialect_ = ColaDialect::kText;
  std::int64_t waits_since_ns_ = 0;  // start of the wait for an answer or a scan
  int starts_ = 0;                   // consecutive starts without a scan
  std::optional<ColaScan> last_;
  std::int64_t device_ns_ = 0;  // sent_us of the last scan, without wrapping
  std::int64_t last_stamp_ns_ = 0;
  bool running_ = false;                    // scans came since the start
  std::optional<std::uint32_t> before_us_;  // start_us of the last scan before the start

  std::string device_;
  std::uint8_t status_ = 0;
  double turns_hz_ = 0.0;
  std::uint64_t silences_ = 0;
  std::uint64_t implausible_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t other_beams_ = 0;
  std::uint64_t missed_ = 0;  // lost scans, by the laser's counter
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
