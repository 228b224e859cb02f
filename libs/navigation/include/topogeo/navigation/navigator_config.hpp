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

/// What Markov localization holds probabilities of.
enum class MarkovGrid : std::uint8_t {
  /// Positions and headings; sonars are heard while the robot drives (markov/pose_localizer.hpp).
  kPoses = 0,
  /// MACONDO's window of positions, by its matrices and weights (markov/markov_localizer.hpp). The
  /// robot stops to hear its sonars at border nodes and at the end of its route.
  kPositions = 1,
};

struct MarkovTrackerConfig {
  MarkovGrid grid = MarkovGrid::kPoses;
  markov::MarkovConfig markov;
  markov::PoseGridConfig poses;
  double cell_m = 0.1;
  double heading_sigma_rad = 0.05;
  std::string station = "base station";  ///< place of the map that the robot starts at
  double station_heading_rad = 0.0;      ///< map frame
};

/// Declares the part of the section `markov` that is about the map and the robot.
void describe(MarkovTrackerConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const MarkovTrackerConfig& config);

enum class MotionStyle : std::uint8_t {
  kSmooth = 0,      ///< arcs around the corners, for bases that take velocities
  kPrimitives = 1,  ///< advance, turn left, turn right (docs/algorithms.md, "Motion primitives")
};

/// Where the pose comes from.
enum class PoseSource : std::uint8_t {
  kLocalizer = 0,  ///< pose fixes that are added
  /// Markov localization (docs/algorithms.md, "Markov localization") on the map's grid. The base
  /// station is the place of the map with that name, without one the first pose fix that is added.
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
  bool markov_by_laser = false;  ///< ranges for Markov localization from the laser, not the sonars
  MarkovTrackerConfig markov;
  /// Of the local map of the moment, by which detours lead; the same as the local mapper's.
  voronoi::VoronoiConfig voronoi;
  topomap::LocalMapConfig local_map;
};

/// Declares what this library has in the sections `navigator`, `markov` and `guard`; path, detour,
/// Markov model and local map are declared by the libraries of their settings.
void describe(NavigatorConfig& config, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range, also for the parts of other libraries.
void check(const NavigatorConfig& config);

}  // namespace topogeo::navigation
