// Removes the motion of a laser during a scan, whose beams are measured one after the other.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/echo_grid.hpp"

namespace topogeo::scan {

/// Ranges on a grid of beams, and when they were measured.
struct TimedRanges {
  EchoGrid grid;
  std::vector<float> ranges_m;  ///< Scan::kNoReturn: no echo
  double first_beam_s = 0.0;    ///< time of the first after the stamp
  double beam_step_s = 0.0;     ///< from one to the next, of either sign

  /// Time after the stamp of the beam farthest from it; negative if before.
  [[nodiscard]] double farthest_s() const;
};

/// The ranges as if all had been measured at the stamp, on the same beams. `T_odom_laser_after`
/// gives the laser's pose that many seconds after the stamp; if it returns none, or none with
/// finite numbers, the range is not changed. No range changes if the motion is too small for the
/// beams to show: up to 2 mm and 0.001 rad.
std::vector<float> deskewed(
    const TimedRanges& scan,
    const std::function<std::optional<geometry::Pose2>(double)>& T_odom_laser_after);

}  // namespace topogeo::scan
