// Settings of the local mapper: the distance between stops and the content of their local maps.
#pragma once

#include <cstdint>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match_config.hpp"
#include "topogeo/topomap/local_map_config.hpp"
#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::pipeline {

struct LocalMapperConfig {
  double stop_distance_m = 1.0;
  double stop_turn_rad = 0.35;
  std::uint32_t longest_track = 256;
  voronoi::VoronoiConfig voronoi;
  topomap::LocalMapConfig local_map;
  geometry::Pose2 T_robot_laser;  ///< mounting of the laser
  localization::ScanTrackerConfig tracker;
};

/// Declares the sections `laser` and `stop`.
void describe(LocalMapperConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::pipeline
