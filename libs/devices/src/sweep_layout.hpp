// Scans of lasers that sweep less than a turn, one beam after the other, counter-clockwise.
#pragma once

#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

/// A sweep as the laser measures it.
struct Sweep {
  double first_rad = 0.0;  ///< direction of the first beam from the x axis of the laser
  double step_rad = 0.0;   ///< from one beam to the next, > 0
  double step_s = 0.0;
  std::vector<float> ranges_m;  ///< one or more beams; scan::Scan::kNoReturn
};

/// Sets the beams of a scan, with directions, ranges and times about its middle. The beams of a
/// laser that hangs upside down are mirrored.
void lay_out(Sweep sweep, bool upside_down, LaserScan& scan);

}  // namespace topogeo::devices
