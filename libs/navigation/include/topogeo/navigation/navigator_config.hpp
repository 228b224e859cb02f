// Settings of the navigator.
#pragma once

#include <cstdint>

#include "topogeo/markov/markov_config.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/planning/detour_config.hpp"
#include "topogeo/planning/motion_config.hpp"

namespace topogeo::navigation {

struct MarkovTrackerConfig {
  markov::MarkovConfig markov;
  double cell_m = 0.1;  ///< of the belief; cells of the map are joined up to it, [0.01, 1]
  double heading_sigma_rad = 0.05;  ///< of the heading, which is taken from odometry, [0.001, 1]
};

enum class MotionStyle : std::uint8_t {
  kSmooth = 0,      ///< arcs round the corners, for bases that take velocities
  kPrimitives = 1,  ///< advance, turn left, turn right, one after the other
};

/// Where the pose comes from.
enum class PoseSource : std::uint8_t {
  kLocalizer = 0,  ///< pose fixes that are added
  /// Markov localization on the map's grid: the first pose fix that is added is the base
  /// station. The robot stops at every border node and at the end of the route to look where it is.
  kMarkov = 1,
};

struct NavigatorConfig {
  MotionStyle motion = MotionStyle::kSmooth;
  double speed_m_per_s = 0.6;                 ///< at most, (0, 3]
  double turn_rad_per_s = 1.0;                ///< at most, (0, 6]
  double acceleration_m_per_s2 = 0.5;         ///< (0, 10]
  double turn_acceleration_rad_per_s2 = 2.0;  ///< (0, 20]
  double delay_s = 0.15;           ///< from a command until the base obeys it, about, [0, 1]
  double arrival_m = 0.03;         ///< so near to the goal it has arrived, [0.005, 1]
  double arrival_rad = 0.02;       ///< and so near to the heading, [0.002, 1]
  double settle_s = 0.5;           ///< stands so long at the goal and looks where it is, [0, 10]
  double oldest_pose_s = 3.0;      ///< an older pose fix is none, [0.1, 60]
  double oldest_odometry_s = 1.0;  ///< [0.1, 10]
  double largest_sigma_m = 0.5;    ///< a pose that is less certain is lost, [0.05, 5]
  double obstacle_wait_s =
      4.0;  ///< for what may move away, before another route is asked for, [0, 600]
  double blockage_s = 60.0;    ///< so long a blockage is believed without being seen, [1, 86400]
  double route_wait_s = 5.0;   ///< for the planner to answer, [0.1, 600]
  double stuck_s = 2.0;        ///< told to move, and does not: stuck, [0.2, 60]
  double look_around_m = 5.0;  ///< how far it may go without a pose, where it may, [0, 50]
  GuardConfig guard;
  planning::DetourConfig detour;
  planning::SmoothPathConfig smooth;
  PoseSource pose_source = PoseSource::kLocalizer;
  bool markov_by_laser = false;  ///< ranges for Markov localization from the laser, not the sonars
  MarkovTrackerConfig markov;
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const NavigatorConfig& config);

}  // namespace topogeo::navigation
