// Laser scans of ROS (sensor_msgs/LaserScan, REP 103) as beams that ascend at one step, which is
// what we work on: clockwise and inverted scanners turned round, the motion during a turn of the
// mirror taken out, numbers of beams that vary put on one pattern.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::ros {

/// Directions of the beams, laser frame, upright.
struct BeamPattern {
  double angle_min_rad = 0.0;
  double angle_step_rad = 0.0;  ///< > 0
  std::size_t beams = 0;
};

/// "720 beams from -3.1416 rad by 0.00873 rad".
std::string text_of(const BeamPattern& pattern);

/// No beam is farther off than 0.0001 rad.
bool same_beams(const BeamPattern& a, const BeamPattern& b);

/// Whether the two are of one laser, one of which lacks beams: half of the wider field of view is
/// common to both, and no step is more than twice the other.
bool alike(const BeamPattern& a, const BeamPattern& b);

/// When the rays of a message were measured. `time_increment` cannot be taken at its word: drivers
/// of clockwise scanners turn the ranges round and leave it (tests/bench/RESULTS.md, "Recordings of
/// ROS").
enum class SweepOrder : std::uint8_t {
  kNone,     ///< all at the stamp
  kForward,  ///< as the message states: the first at the stamp, each one time_increment later
  kBackward  ///< the first at the stamp, each one time_increment earlier: the last was the first
};

/// Of "none", "forward" and "backward"; throws std::invalid_argument for another.
SweepOrder sweep_order(std::string_view name);

/// One turn of the mirror.
struct Sweep {
  BeamPattern pattern;
  std::vector<float> ranges_m;  ///< by ascending angle; Scan::kNoReturn: no echo
  double time_step_s = 0.0;     ///< from one beam to the next of ranges_m, of any sign
  double first_beam_s = 0.0;    ///< of ranges_m, after the stamp

  /// Of the beam farthest from the stamp, after it; negative before it.
  [[nodiscard]] double farthest_s() const;
};

/// The beams of a message, `upside_down` seen from above: mirrored about the x axis of its frame.
/// Of more than `most_beams` every second, third ... is taken. Throws std::invalid_argument naming
/// the field ("expected ..., got ...") for beams that no laser has.
BeamPattern pattern_of(const LaserScan& message, bool upside_down, std::size_t most_beams);

/// The same with ranges and times. A range is an echo when it is above 0, not below range_min, and,
/// where range_max is stated, below that. Throws the same, also for times that no laser has.
Sweep to_sweep(const LaserScan& message, bool upside_down, std::size_t most_beams,
               SweepOrder order = SweepOrder::kNone);

/// The ranges of the sweep on the beams of `pattern`: those of the nearest beam within half a step
/// of the coarser one, no echo where there is none.
std::vector<float> on_pattern(const Sweep& sweep, const BeamPattern& pattern);

/// The ranges as if all had been measured at the stamp, on the beams of the sweep.
/// `T_odom_laser_after` gives the laser's pose so many seconds after the stamp; where it has none,
/// or none of finite numbers, the range stays as it was measured. The ranges stay as they are where
/// the beams do not show the motion: below 2 mm and 0.001 rad.
std::vector<float> deskewed(
    const Sweep& sweep,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after);

/// Ranges at or above the limit become no echo.
void limit_ranges(std::vector<float>& ranges_m, double range_limit_m);

/// The other way, with stamp; a beam without an echo becomes +inf. `range_max_m`: of the laser.
LaserScan to_laser_scan(const scan::Scan& scan, const std::string& frame_id, float range_max_m);

}  // namespace topogeo::ros
