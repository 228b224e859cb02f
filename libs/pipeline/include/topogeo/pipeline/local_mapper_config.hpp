// Settings of the local mapper: when a stop is made and what its local map is.
#pragma once

#include <cstdint>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/tracking/scan_tracker_config.hpp"
#include "topogeo/topomap/local_map_config.hpp"
#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::pipeline {

struct LocalMapperConfig {
  double stop_distance_m = 1.0;       ///< a stop is made this far from the one before
  double stop_turn_rad = 0.35;        ///< or after this much turn
  std::uint32_t longest_track = 256;  ///< scans between two stops; also the bound on the wire
  voronoi::VoronoiConfig voronoi;
  topomap::LocalMapConfig local_map;
  geometry::Pose2 T_robot_laser;  ///< mounting of the laser
  localization::ScanTrackerConfig tracker;
};

}  // namespace topogeo::pipeline
