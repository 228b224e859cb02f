// Settings of the navigator.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/markov/markov_config.hpp"
#include "topogeo/navigation/follower_config.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/planning/detour_config.hpp"
#include "topogeo/planning/motion_config.hpp"
#include "topogeo/topomap/local_map_config.hpp"
#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::navigation {

/// The states that Markov localization assigns probabilities to.
enum class MarkovGrid : std::uint8_t {
  /// Positions and headings; uses the sonars while driving (markov/pose_localizer.hpp).
  kPoses = 0,
  /// MACONDO's window of positions, by its matrices and weights (markov/markov_localizer.hpp). The
  /// robot stops for its sonars at border nodes and at the end of its route.
  kPositions = 1,
};

struct MarkovTrackerConfig {
  MarkovGrid grid = MarkovGrid::kPoses;
  markov::MarkovConfig markov;
  markov::PoseGridConfig poses;
  double cell_m = 0.1;
  double heading_sigma_rad = 0.05;
  std::string station = "base station";  ///< named place where the robot starts
  double station_heading_rad = 0.0;      ///< map frame
};

/// Declares the settings of the section `markov` about the map and the robot.
void describe(MarkovTrackerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const MarkovTrackerConfig& config);

enum class MotionStyle : std::uint8_t {
  kSmooth = 0,      ///< arcs around the corners, for bases that take velocities
  kPrimitives = 1,  ///< advance, turn left, turn right (docs/algorithms.md, "Motion primitives")
};

/// Source of the pose.
enum class PoseSource : std::uint8_t {
  kLocalizer = 0,  ///< pose fixes that are added
  /// Markov localization (docs/algorithms.md, "Markov localization") on the map's grid. The base
  /// station is the place with that name on the map, or else the first pose fix that is added.
  kMarkov = 1,
};

struct NavigatorConfig {
  MotionStyle motion = MotionStyle::kSmooth;
  FollowerConfig follower;
  double settle_s = 0.5;
  double oldest_pose_s = 3.0;
  double oldest_odometry_s = 1.0;
  double largest_sigma_m = 0.5;
  double obstacle_wait_s = 4.0;
  double blockage_s = 60.0;
  double route_wait_s = 5.0;
  double stuck_s = 2.0;
  double look_around_m = 5.0;
  GuardConfig guard;
  planning::DetourConfig detour;
  planning::SmoothPathConfig smooth;
  PoseSource pose_source = PoseSource::kLocalizer;
  bool markov_by_laser = false;  ///< Markov localization uses the laser's ranges, not the sonars
  MarkovTrackerConfig markov;
  /// For the momentary local map that detours follow; the same as the local mapper's.
  voronoi::VoronoiConfig voronoi;
  topomap::LocalMapConfig local_map;
};

/// Declares this library's settings in the sections `navigator`, `markov` and `guard`; other
/// libraries declare path, detour, Markov model and local map.
void describe(NavigatorConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range, also for parts of other libraries.
void check(const NavigatorConfig& config);

}  // namespace topogeo::navigation
