// Which segments of a trajectory have to be sent again after a change.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localizer {

class TrajectoryUpdates {
 public:
  /// Segments with a stop that is new or differs in any bit from what update() saw last, ascending.
  /// After a usual step that is the last one, when stops got other numbers all.
  std::vector<std::uint32_t> update(const topomap::Trajectory& trajectory);

 private:
  std::vector<topomap::StopPose> last_;
  std::uint64_t numbered_since_ = 0;
};

}  // namespace topogeo::localizer
