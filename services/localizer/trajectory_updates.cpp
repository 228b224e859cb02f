#include "trajectory_updates.hpp"

#include "topogeo/msg/common.h"

namespace topogeo::localizer {

std::vector<std::uint32_t> TrajectoryUpdates::update(const topomap::Trajectory& trajectory) {
  std::vector<std::uint32_t> changed;
  if (trajectory.numbered_since != numbered_since_) last_.clear();
  numbered_since_ = trajectory.numbered_since;
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    const auto segment = static_cast<std::uint32_t>(i / msg::kSegmentStops);
    if (!changed.empty() && changed.back() == segment) continue;
    const topomap::StopPose& stop = trajectory.stops[i];
    if (i >= last_.size() || last_[i].T_map_robot != stop.T_map_robot ||
        last_[i].covariance != stop.covariance) {
      changed.push_back(segment);
    }
  }
  last_ = trajectory.stops;
  return changed;
}

}  // namespace topogeo::localizer
