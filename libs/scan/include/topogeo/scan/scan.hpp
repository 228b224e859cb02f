// A laser scan with its odometry: the input of the system.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::scan {

struct Scan {
  std::uint64_t sequence = 0;  ///< counts the usable scans of one source from 0, without gaps
  std::int64_t stamp_ns =
      0;  ///< time of measurement, since the epoch of the device or log; strictly increasing
  double angle_min_rad = 0.0;    ///< angle of the first beam in the laser frame (x forward, y left)
  double angle_step_rad = 0.0;   ///< from one beam to the next, counter-clockwise, > 0
  std::vector<float> ranges_m;   ///< one per beam; kNoReturn without an echo
  geometry::Pose2 T_odom_robot;  ///< odometry pose at the time of the scan
  /// Odometry poses of different epochs are unrelated: the base, or its reader, restarted between
  /// them, or they belong to different logs.
  std::uint64_t odometry_epoch = 0;
  /// Time of the first beam after the stamp, and from one beam to the next, of either sign; both 0
  /// if all beams count as measured at the stamp.
  double first_beam_s = 0.0;
  double beam_step_s = 0.0;

  /// Range of a beam without an echo. Readers of logs and devices use it for every reading at or
  /// above the sensor's maximum and for every reading of zero or less.
  static constexpr float kNoReturn = 0.0F;
};

/// A number that identifies a scan by its time and ranges.
std::uint64_t fingerprint(const Scan& scan);

}  // namespace topogeo::scan
