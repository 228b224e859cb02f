// The time by which the stamps of scans are later than those of odometry, from turns of the robot.
//
// A motion of the laser that begins or ends within a turn of the robot, but not both, contains
// another part of that turn if the stamps of the two differ by another time. The delay under which
// most motions turn as far by the scans as by odometry is searched, and counts if enough motions
// speak for it and hardly any for no delay.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "topogeo/calibration/mounting_search.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// Turn of the robot by odometry between two times, counter-clockwise, rad; empty if unknown.
using OdometryTurn =
    std::function<std::optional<double>(std::int64_t first_ns, std::int64_t last_ns)>;

struct ScanDelay {
  double delay_s = 0.0;  ///< positive: the stamps of scans are later
  MountingVotes votes;   ///< of the motions, between this delay and none
};

/// The delay if the motions decide for one of at least 0.1 s, to a hundredth; those up to 0.5 s to
/// either side are searched. `upside_down`: the scans turn the other way.
std::optional<ScanDelay> find_scan_delay(std::span<const LaserMotion> motions,
                                         const OdometryTurn& turn_rad, bool upside_down);

}  // namespace topogeo::localization
