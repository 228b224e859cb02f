#include <stdexcept>
#include <string>

#include "topogeo/slam/pose_graph.hpp"

namespace topogeo::localization {

const UncertainPose& RelativePoses::at(std::uint32_t id) const {
  const UncertainPose* found = find(id);
  if (found == nullptr) {
    throw std::out_of_range("relative poses: stop " + std::to_string(id) + " was not reached");
  }
  return *found;
}

std::vector<UncertainPose> RelativePoses::by_id(std::size_t count) const {
  constexpr double kAway_m = 1e6;
  std::vector<UncertainPose> all(count, {{kAway_m, kAway_m, 0.0}, Eigen::Matrix3d::Zero()});
  for (const Stop& stop : stops_) all.at(stop.id) = stop.T_origin_stop;
  return all;
}

}  // namespace topogeo::localization
