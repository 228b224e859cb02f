// Drives a Hokuyo laser by SCIP 2.0: asks it for its name, its sweep and its time, then reads scans
// without end. The line is a serial port, the laser's own USB port, or a network connection.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/scip_clock.hpp"
#include "topogeo/devices/scip_protocol.hpp"
#include "topogeo/devices/scip_settings.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

class ScipDriver final : public LaserDriver {
 public:
  /// Throws std::invalid_argument when a setting is out of range.
  ScipDriver(const LaserModel& model, const TurningLaserSettings& turning,
             const ScipSettings& settings);

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
  enum class Step : std::uint8_t {
    kProtocol,  ///< an URG-04LX may speak SCIP 1.1
    kQuit,      ///< ends a scan of an earlier program
    kVersion,
    kParameters,
    kState,
    kTimeBegin,
    kTime,  ///< several times
    kTimeEnd,
    kMeasure,
    kScans
  };

  void start(std::int64_t now_ns);
  void ask(Step step, std::int64_t now_ns);
  void ask_next(std::int64_t now_ns);
  [[nodiscard]] std::string command_of(Step step) const;
  /// The laser works without an answer to this command.
  [[nodiscard]] static bool optional(Step step);
  void take(const std::string& text, std::int64_t now_ns);
  /// Reads the answer to the present command; false: it is none.
  [[nodiscard]] bool take_answer(const std::string& text, std::int64_t now_ns);
  void take_scan(const std::string& text, std::int64_t now_ns);
  void refuse(const std::string& status);
  [[nodiscard]] std::optional<LaserScan> to_scan(const ScipScan& scan, std::int64_t now_ns);
  [[nodiscard]] float range_m(const ScipScan& scan, std::size_t beam) const;
  void measure_period();
  /// The laser answers, but does not measure as wanted.
  [[nodiscard]] bool refused() const {
    return !wrong_model_.empty() || (step_ == Step::kMeasure && !fault_.empty());
  }
  void fall_silent(std::int64_t now_ns);

  const LaserModel& model_;
  TurningLaserSettings turning_;
  ScipSettings settings_;
  LineSettings line_;
  ScipReader reader_;
  ScipClock clock_;

  LaserState state_ = LaserState::kOffline;
  std::string reason_ = "the port is closed";
  Step step_ = Step::kProtocol;
  std::string command_;         // that waits for an answer, or gives scans
  std::int64_t asked_ns_ = 0;   // of command_
  int tries_ = 0;               // of command_
  int times_ = 0;               // answers to TM1
  std::int64_t heard_ns_ = 0;   // last scan
  std::uint64_t failures_ = 0;  // starts in a row without a scan

  ScipParameters sweep_;
  ScipScanRequest request_;
  double period_ns_ = 0.0;
  std::int64_t last_stamp_ns_ = 0;

  std::string device_;
  std::string fault_;
  std::string wrong_model_;  // the reason, if the laser has another sweep
  std::uint16_t error_level_ = 0;
  std::uint64_t silences_ = 0;
  std::uint64_t damaged_ = 0;      // answers with a wrong sum, echo or length
  std::uint64_t repeated_ = 0;     // scans whose stamp does not follow the last one
  std::uint64_t refused_ = 0;      // scans with the status of a fault
  std::uint64_t noise_bytes_ = 0;  // before an echo
  std::uint64_t missed_ = 0;       // scans, by the time between two stamps
  std::vector<LineOrder> orders_;
  std::vector<LaserScan> scans_;
};

}  // namespace topogeo::devices
