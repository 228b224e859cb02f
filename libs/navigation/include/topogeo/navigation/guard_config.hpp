// Settings of the collision guard.
#pragma once

namespace topogeo::navigation {

struct GuardConfig {
  double radius_m = 0.267;             ///< of the robot's round body, [0.05, 2]
  double margin_m = 0.05;              ///< it stops so far before what is in its way, [0, 1]
  double side_margin_m = 0.02;         ///< it passes what is beside it at this distance, [0, 1]
  double deceleration_m_per_s2 = 0.5;  ///< that the base surely can, [0.05, 10]
  double delay_s = 0.25;               ///< from a measurement until the base obeys, [0, 2]
  double oldest_scan_s = 0.6;          ///< an older scan is none, [0.05, 10]
  bool needs_scan = true;              ///< no motion without one; false: sonars are enough
  bool needs_sonar = false;            ///< no motion without sonars
  double sonar_reach_m = 1.5;   ///< sonars must hear what the laser sees nearer than this in their
                                ///< cone, [0.2, 5]
  double sonar_least_m = 0.16;  ///< a sonar that looks ahead or back and reads this or less may be
                                ///< about to be touched, [0, 1]
  double silent_s = 1.0;        ///< that long without any echo where there must be one, and the
                                ///< sonars count as silent, [0.1, 60]
};

}  // namespace topogeo::navigation
