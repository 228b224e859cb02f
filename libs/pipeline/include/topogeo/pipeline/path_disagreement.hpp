// Where the corrected path of a map contradicts the recorded odometry.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::pipeline {

/// A part of the path on which the map and odometry differ by more than odometry errs.
struct PathDisagreement {
  enum class Kind : std::uint8_t {
    kLength,  ///< the corrected path is much longer or shorter
    kTurn,    ///< the robot turns in the map and not by odometry, or the reverse
    kJump,    ///< from one scan to the next the robot moves in the map and not by odometry
    kWheels,  ///< the scans contradict odometry, which does not count (OdometryContradiction)
    kCarried  ///< the robot goes on at another place, where the scans have found it again
  };
  Kind kind = Kind::kLength;
  std::uint32_t first_id = 0;  ///< local map ids of the stops around the part
  std::uint32_t last_id = 0;
  double odometry_m = 0.0;   ///< length of the worst 3 m, of the jump, or of all, by odometry
  double corrected_m = 0.0;  ///< the same in the map
  /// Turn in the map less that of odometry, in [-pi, pi]; kinds kTurn and kWheels.
  double turn_rad = 0.0;
};

struct PathComparison {
  std::vector<PathDisagreement> disagreements;  ///< in the order of the path, by kind
  /// Median displacement between both over 3 m of odometry, divided by 3 m; 0: shorter drives.
  double typical_share = 0.0;
  /// Median length of those parts in the map over that by odometry, if nine of ten of them differ
  /// by half as much or more to the same side; else 1.
  double scale = 1.0;
};

/// Compares all parts of 3 m, and all pairs of consecutive scans; stops of different drives or with
/// another origin of odometry are never compared, nor steps whose odometry does not count. The
/// thresholds (a fifth of the length, 50 degrees, 0.6 m) are above what recorded logs with poor
/// odometry need (docs/decisions/ map_quality.md).
PathComparison compare_with_odometry(const storage::MapDocument& document);

}  // namespace topogeo::pipeline
