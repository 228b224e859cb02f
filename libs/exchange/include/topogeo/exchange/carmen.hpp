// The scans of a map's stops as a laser log, which other SLAM programs read (docs/exchange.md,
// "CARMEN").
#pragma once

#include <vector>

#include "topogeo/scan/scan.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct StopScans {
  std::vector<scan::Scan> scans;  ///< of the stops that saw anything, with their odometry
  geometry::Pose2 T_robot_laser;  ///< of the first stop
  double angle_error_rad = 0.0;   ///< largest difference between a point and its beam
  std::size_t lost_points = 0;    ///< two in one beam: the nearer one is kept
};

/// A map keeps points and not beams: all scans get the beams that most of their points lie on. A
/// later drive whose stamps do not follow those before is shifted to a minute after them, since
/// logs run forward. Throws std::invalid_argument for a map without scan points.
StopScans stop_scans(const storage::MapDocument& document);

}  // namespace topogeo::exchange
