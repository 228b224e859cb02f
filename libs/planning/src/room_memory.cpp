#include "topogeo/planning/room_memory.hpp"

namespace topogeo::planning {

StopPoses poses_of(std::span<const topomap::StopPose> stops) {
  StopPoses poses;
  for (const topomap::StopPose& stop : stops) {
    if (stop.located) poses.emplace(stop.stop, stop.T_map_robot);
  }
  return poses;
}

std::optional<Eigen::Vector2d> position_of(const RoomPoint& point, const StopPoses& poses) {
  if (!point.stop) return point.position_m;
  const auto found = poses.find(*point.stop);
  if (found == poses.end()) return std::nullopt;
  return found->second * point.position_m;
}

std::string room_name(std::uint32_t number) {
  return "room " + std::to_string(number);
}

}  // namespace topogeo::planning
