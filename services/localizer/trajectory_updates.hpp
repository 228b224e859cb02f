// Finds the segments of a trajectory that must be sent again after a change.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localizer {

class TrajectoryUpdates {
 public:
  /// Segments with a stop that is new or differs in any bit from the last update(), ascending.
  /// Usually only the last one; all of them after a renumbering of stops.
  std::vector<std::uint32_t> update(const topomap::Trajectory& trajectory);

 private:
  std::vector<topomap::StopPose> last_;
  std::uint64_t numbered_since_ = 0;
};

}  // namespace topogeo::localizer
