// Laser scans of ROS as beams that ascend at one step, which is what we work on: clockwise and
// inverted scanners turned round, numbers of beams that vary put on one pattern, the motion during
// a turn of the mirror taken out.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_messaging/messages.hpp"

namespace topogeo::ros_bridge {

/// Directions of the beams, laser frame, upright.
struct BeamPattern {
  double angle_min_rad = 0.0;
  double angle_step_rad = 0.0;  ///< > 0
  std::size_t beams = 0;
};

/// One turn of the mirror.
struct Sweep {
  BeamPattern pattern;
  std::vector<float> ranges_m;  ///< by ascending angle; 0: no echo
  double time_step_s = 0.0;  ///< from one beam to the next of ranges_m; negative for clockwise ones
  double first_beam_s = 0.0;  ///< of ranges_m, after the stamp
};

/// What a message says, `upside_down` seen from above: mirrored about the x axis of its frame. A
/// range outside [range_min, range_max], infinite or no number is no echo. Throws
/// std::invalid_argument naming the field where the message has no beams, or angles or times that
/// are not finite, or a step of none.
Sweep to_sweep(const ros::LaserScan& message, bool upside_down);

/// Every n-th beam, n the least for which at most `most` remain.
Sweep thinned(Sweep sweep, std::size_t most);

/// The ranges of the sweep on the beams of `pattern`: those of the nearest beam within half a step
/// of the coarser one, no echo where there is none.
std::vector<float> on_pattern(const Sweep& sweep, const BeamPattern& pattern);

/// The ranges as if all had been measured at the stamp, which is that of the first ray, on the
/// beams of the sweep. `T_odom_laser_after` gives the laser's pose so many seconds after the stamp;
/// where it has none the range stays as it was measured.
std::vector<float> deskewed(
    const Sweep& sweep,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after);

}  // namespace topogeo::ros_bridge
