// Sets up a SICK laser that was found: stops its stream, changes its rate in installation mode and
// returns to the old one if the sensor does not follow, reads its status and errors, and starts its
// scans.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/pls_line.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/sick_exchange.hpp"

namespace topogeo::devices {

class PlsSetup {
 public:
  enum class Result : std::uint8_t {
    kGoesOn,
    kDone,         ///< the sensor sends scans, or waits for requests
    kNotFollowed,  ///< it is not heard at the new rate; a search is needed
    kFailed        ///< it did not obey, see reason()
  };

  /// Keeps references to all arguments.
  PlsSetup(const PlsSettings& settings, PlsLine& line, SickExchange& exchange)
      : settings_(settings), line_(line), exchange_(exchange) {}

  /// Begins with a sensor that may be sending scans.
  void start(std::int64_t now_ns) { begin(Step::kStop, now_ns); }
  /// Begins with a sensor whose stream was stopped.
  void start_stopped(std::int64_t now_ns);
  /// The exchange has ended.
  Result go_on(std::int64_t now_ns);
  void tick(std::int64_t now_ns);
  /// The end of a rest; the largest number outside of one.
  [[nodiscard]] std::int64_t due_ns() const;

  /// The present step, or the reason of a failure.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// The reason why the sensor runs at another rate than wanted; empty if it does not.
  [[nodiscard]] const std::string& fallback() const { return fallback_; }
  /// The sensor restarted or was silent, so it may now follow to the wanted rate.
  void retry_rate();
  /// When a sensor that runs at another rate than wanted should get another try, because a busy
  /// machine or a disturbance may have been the reason; the largest number: never.
  [[nodiscard]] std::int64_t retry_at_ns() const { return retry_at_ns_; }
  /// Number of failures since reset().
  [[nodiscard]] int failures() const { return failures_; }
  /// Scans come, or the port was opened.
  void reset() { failures_ = 0; }

 private:
  enum class Step : std::uint8_t {
    kStop,     ///< stopping the stream
    kInstall,  ///< asking for installation mode
    kRate,     ///< asking for the rate
    kSettle,   ///< resting after a change of the rate
    kProve,    ///< asking for an answer at the new rate
    kStatus,
    kErrors,
    kMonitor,  ///< asking for scans
  };

  void begin(Step step, std::int64_t now_ns);
  void ask_for_rate(std::int64_t now_ns);
  [[nodiscard]] std::string name(Step step) const;
  [[nodiscard]] std::vector<std::uint8_t> command(Step step) const;
  [[nodiscard]] SickExchange::Limits limits(Step step) const;
  Result after_stop(std::int64_t now_ns);
  Result after_install(std::int64_t now_ns);
  Result after_rate(std::int64_t now_ns);
  Result after_prove(std::int64_t now_ns);
  Result after_monitor();
  Result fall_back(const std::string& why, std::int64_t now_ns);
  Result fail(std::string reason);
  [[nodiscard]] bool replied() const;

  const PlsSettings& settings_;
  PlsLine& line_;
  SickExchange& exchange_;
  Step step_ = Step::kStop;
  std::string reason_;
  std::string fallback_;
  std::int64_t retry_at_ns_ = std::numeric_limits<std::int64_t>::max();
  int fallbacks_ = 0;  // since the sensor was heard at the wanted rate
  std::int64_t settled_ns_ = 0;
  int failures_ = 0;
  int failed_switches_ = 0;
  int refused_rates_ = 0;  // in a row
};

}  // namespace topogeo::devices
