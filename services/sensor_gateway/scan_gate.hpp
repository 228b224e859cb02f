// Combines scans and odometry: numbers and stamps scans, adds the odometry at their time, corrects
// their ranges for the motion during a turn of the laser, and counts unusable scans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/repeated_readings.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::sensor_gateway {

/// Reason why a scan of the laser was not published.
enum class ScanDrop : std::uint8_t {
  kNoReader,    ///< there is no reader yet
  kNoOdometry,  ///< stamped before the first odometry, or too long after the last
  kTime,        ///< not newer than the previous scan
  kGeometry,    ///< angles or number of beams differ from the first scan
  kRepeated     ///< same readings as the previous scan to the last digit, but the robot has moved
};
inline constexpr std::size_t kScanDrops = 5;
/// The reason as text for people.
std::string_view describe(ScanDrop drop);

struct ScanGateOptions {
  bool has_base = true;                       ///< false: the odometry is always the identity
  std::int64_t odometry_wait_ns = 0;          ///< longest wait for odometry after a scan; >= 0
  std::int64_t longest_extrapolation_ns = 0;  ///< see OdometryTrack
  std::uint64_t odometry_epoch = 0;           ///< epoch of the odometry that is added
  double range_max_m = 49.9;                  ///< larger ranges mean no return, as in logs
  geometry::Pose2 T_robot_laser{};            ///< mounting of the laser
};

/// All times are of one steady clock, which may differ from the clock of published stamps.
class ScanGate {
 public:
  explicit ScanGate(const ScanGateOptions& options)
      : options_(options), track_(options.longest_extrapolation_ns) {}

  /// Starts the output; earlier scans are dropped as kNoReader.
  void open() { open_ = true; }
  /// Sets the epoch of the odometry and the number of the next scan. Must precede the first scan.
  void begin(std::uint64_t odometry_epoch, std::uint64_t next_sequence) {
    options_.odometry_epoch = odometry_epoch;
    next_sequence_ = next_sequence;
  }
  void add(devices::LaserScan scan, std::int64_t now_ns);
  void add(const geometry::OdometrySample& sample) { track_.add(sample); }

  struct Leaving {
    scan::Scan scan;              ///< its stamp is a time of the steady clock
    std::int64_t arrival_ns = 0;  ///< time at which the scan was added
  };
  /// The scans that can be published by now, in order.
  std::vector<Leaving> take(std::int64_t now_ns);
  /// Time by which take() returns the oldest waiting scan; the largest int64 while none waits.
  [[nodiscard]] std::int64_t due_ns() const;

  [[nodiscard]] std::uint64_t scans() const { return next_sequence_; }
  [[nodiscard]] std::uint64_t extrapolated() const { return extrapolated_; }
  [[nodiscard]] std::uint64_t dropped(ScanDrop drop) const {
    return drops_[static_cast<std::size_t>(drop)];
  }

 private:
  struct Waiting {
    devices::LaserScan scan;
    std::int64_t arrival_ns = 0;
  };
  struct Geometry {
    double angle_min_rad = 0.0;
    double angle_step_rad = 0.0;
    std::size_t beams = 0;
    friend bool operator==(const Geometry&, const Geometry&) = default;
  };

  std::optional<scan::Scan> finish(devices::LaserScan&& scan);
  /// The ranges, corrected as if all beams had been measured at the stamp.
  [[nodiscard]] std::vector<float> ranges_at_stamp(devices::LaserScan&& scan) const;
  void drop(ScanDrop reason) { ++drops_[static_cast<std::size_t>(reason)]; }

  ScanGateOptions options_;
  geometry::OdometryTrack track_;
  bool open_ = false;
  std::deque<Waiting> waiting_;
  std::optional<Geometry> geometry_;
  scan::RepeatedReadings repeated_{1};
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t next_sequence_ = 0;
  std::uint64_t extrapolated_ = 0;
  std::array<std::uint64_t, kScanDrops> drops_{};
};

}  // namespace topogeo::sensor_gateway
