// Makes scans from the measured values of a SICK PLS or LMS, or drops them for a reason.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/pls_messages.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/sick_telegram.hpp"

namespace topogeo::devices {

/// Counts of scans that were received whole but dropped.
struct PlsScanDrops {
  std::uint64_t beam_count = 0;  ///< not one of 361, 181, 180 (180 deg) and 401, 201, 101 (100 deg)
  std::uint64_t interlaced = 0;  ///< part of a scan of an LMS at 0.25 deg
  std::uint64_t implausible = 0;   ///< the sensor calls it implausible
  std::uint64_t sensor_error = 0;  ///< the sensor reports an error or a fatal error
  std::uint64_t stuck = 0;         ///< repeats the same bytes
  bool operator==(const PlsScanDrops&) const = default;
};

class PlsScanMaker {
 public:
  /// Keeps a reference to `settings`.
  explicit PlsScanMaker(const PlsSettings& settings) : settings_(settings) {}

  /// The scan of a telegram with measured values that came over `line`, or nothing if it is
  /// dropped.
  [[nodiscard]] std::optional<LaserScan> make(const PlsMeasuredValues& values,
                                              const SickTelegram& telegram,
                                              const LineSettings& line);

  /// Does not compare the next scan with the last one, which another sensor may have sent.
  void forget() { last_.clear(); }

  [[nodiscard]] const PlsScanDrops& drops() const { return drops_; }
  /// Whether the last scan was dropped as stuck.
  [[nodiscard]] bool stuck() const { return stuck_; }

 private:
  [[nodiscard]] bool is_stuck(const PlsMeasuredValues& values, std::size_t returns);
  [[nodiscard]] std::int64_t stamp(const SickTelegram& telegram, const LineSettings& line) const;

  const PlsSettings& settings_;
  PlsScanDrops drops_;
  std::vector<std::uint8_t> last_;
  int identical_ = 0;
  bool stuck_ = false;
  std::optional<std::int64_t> last_stamp_ns_;
};

}  // namespace topogeo::devices
