// Odometry of two wheels whose ticks the base counts: reports with the base's time and counts that
// wrap become poses. A report that no base can have sent after the last one is doubted; two that
// follow each other show a base that restarted, and the pose goes on from where it was.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/device_clock.hpp"

namespace topogeo::devices {

struct WheelUnits {
  double ticks_per_m = 2000.0;
  double track_m = 0.2;     ///< between the wheels
  unsigned tick_bits = 32;  ///< of a count, which then wraps
  unsigned time_bits = 32;  ///< of the base's time
  std::int64_t time_unit_ns = 1'000'000;
};

struct WheelReport {
  std::uint32_t time = 0;                ///< of the base, in its unit; wraps
  std::array<std::uint32_t, 2> ticks{};  ///< of the left and the right wheel, forward
  std::optional<double> turn_radps{};    ///< of a gyro, counter-clockwise
  std::optional<double> heading_rad{};   ///< that the base makes of its gyro, counter-clockwise
};

class WheelOdometer {
 public:
  enum class Verdict : std::uint8_t {
    kFirst,      ///< nothing to compare it with
    kMoved,      ///< last() is its odometry
    kRestarted,  ///< the same, and the base counts anew
    kDoubted     ///< dropped
  };

  /// Throws std::invalid_argument for units out of range. `most`: speeds that no motion exceeds by
  /// much.
  WheelOdometer(const WheelUnits& units, const BaseLimits& most);

  Verdict take(const WheelReport& report, std::int64_t now_ns);
  /// No report came for a while: the next one may be that of a base that restarted.
  void silent();

  [[nodiscard]] const WheelUnits& units() const { return units_; }
  [[nodiscard]] const BaseOdometry& last() const { return odometry_; }
  /// Neither wheel has turned between the last two reports.
  [[nodiscard]] bool rests() const { return rests_; }

 private:
  struct Arrival {
    WheelReport report;
    std::int64_t now_ns = 0;
  };
  // All since last_.
  [[nodiscard]] std::int64_t gap_ns(const Arrival& arrival) const;
  [[nodiscard]] std::int64_t passed_ns(const Arrival& arrival) const;
  [[nodiscard]] double moved_m(const Arrival& arrival, std::size_t wheel) const;
  /// Whether the base can have sent it.
  [[nodiscard]] bool follows(const Arrival& arrival) const;
  void move(const Arrival& arrival);

  WheelUnits units_;
  double fastest_mps_;  // of a wheel
  DeviceClock clock_{0};
  std::optional<Arrival> last_;
  std::optional<Arrival> doubted_;  // a report that does not follow last_
  std::int64_t device_ns_ = 0;      // time of the base without wrapping
  bool silent_ = false;
  bool rests_ = false;
  BaseOdometry odometry_;
};

}  // namespace topogeo::devices
