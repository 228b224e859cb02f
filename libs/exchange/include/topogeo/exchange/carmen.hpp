// Exports the scans of a map's stops as a laser log, which other SLAM programs read
// (docs/exchange.md, "CARMEN").
#pragma once

#include <vector>

#include "topogeo/scan/scan.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct StopScans {
  std::vector<scan::Scan> scans;  ///< of the stops with points, with their odometry
  geometry::Pose2 T_robot_laser;  ///< of the first stop
  double angle_error_rad = 0.0;   ///< largest difference between a point and its beam
  std::size_t lost_points = 0;    ///< further points in a beam, of which the nearest is kept
};

/// A map keeps points instead of beams: all scans get the beams that most of their points lie on. A
/// later drive whose stamps do not follow the earlier ones is shifted to a minute after them,
/// because logs run forward. Throws std::invalid_argument for a map without scan points.
StopScans stop_scans(const storage::MapDocument& document);

}  // namespace topogeo::exchange
