// Converts laser scans of ROS (sensor_msgs/LaserScan, REP 103) to our form, beams that ascend by
// one step: clockwise and inverted scanners are reversed, motion during a sweep is removed, varying
// numbers of beams are mapped to one pattern.
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

/// Whether no beam differs by more than 0.0001 rad.
bool same_beams(const BeamPattern& a, const BeamPattern& b);

/// Whether two patterns belong to one laser, although one may lack beams: they share half of the
/// wider field of view, and no step is more than twice the other.
bool alike(const BeamPattern& a, const BeamPattern& b);

/// Times at which the rays of a message were measured. `time_increment` is not reliable: drivers of
/// clockwise scanners reverse the ranges but not its sign (docs/decisions/sweep_order.md).
enum class SweepOrder : std::uint8_t {
  kNone,     ///< all at the stamp
  kForward,  ///< as the message states: the first at the stamp, each next one time_increment later
  kBackward  ///< the first at the stamp, each next one time_increment earlier
};

/// Parses "none", "forward" or "backward"; throws std::invalid_argument for other names.
SweepOrder sweep_order(std::string_view name);

/// One turn of the mirror.
struct Sweep {
  BeamPattern pattern;
  std::vector<float> ranges_m;  ///< by ascending angle; Scan::kNoReturn: no echo
  double time_step_s = 0.0;     ///< from one beam of ranges_m to the next, of any sign
  double first_beam_s = 0.0;    ///< time of the first of ranges_m after the stamp
};

/// The beams of a message; with `upside_down` in plan view: mirrored about the x axis of its frame.
/// If there are more than `most_beams`, keeps every second, third ... one. Throws
/// std::invalid_argument naming the field ("expected ..., got ...") for beams that no laser has.
BeamPattern pattern_of(const LaserScan& message, bool upside_down, std::size_t most_beams);

/// Like pattern_of, with ranges and times. A range is an echo if it is above 0, not below
/// range_min, and below range_max if that is stated. Throws likewise, also for impossible times
/// unless the order is kNone.
Sweep to_sweep(const LaserScan& message, bool upside_down, std::size_t most_beams,
               SweepOrder order = SweepOrder::kNone);

/// The ranges of the sweep on the beams of `pattern`: the range of the nearest beam within half of
/// the coarser step, no echo if there is none.
std::vector<float> on_pattern(const Sweep& sweep, const BeamPattern& pattern);

/// scan::deskewed for a sweep.
std::vector<float> deskewed(
    const Sweep& sweep,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after);

/// Ranges at or above the limit become no echo.
void limit_ranges(std::vector<float>& ranges_m, double range_limit_m);

/// The reverse conversion; a beam without an echo becomes +inf. `range_max_m`: of the laser.
LaserScan to_laser_scan(const scan::Scan& scan, const std::string& frame_id, float range_max_m);

}  // namespace topogeo::ros
