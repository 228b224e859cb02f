#include "live_map.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::map_store {

LiveMap::LiveMap(const topomap::GlobalMapConfig& config) : config_(config), builder_(config) {}

void LiveMap::check(std::span<const topomap::StopPose> stops) {
  if (used_.size() < rebuild_until_) return;
  for (std::size_t i = 0; i < std::min(used_.size(), stops.size()); ++i) {
    const geometry::Pose2 moved = geometry::between(used_[i], stops[i].T_map_robot);
    if (std::hypot(moved.x_m, moved.y_m) <= kMoved_m && std::fabs(moved.theta_rad) <= kTurned_rad) {
      continue;
    }
    builder_ = topomap::GlobalMapBuilder(config_);
    rebuild_until_ = used_.size();
    used_.clear();
    ++rebuilds_;
    return;
  }
}

bool LiveMap::step(std::span<const topomap::LocalMap> maps,
                   std::span<const topomap::StopPose> stops) {
  const std::size_t next = used_.size();
  if (next >= std::min(maps.size(), stops.size())) return false;
  used_.push_back(stops[next].T_map_robot);
  if (stops[next].located) builder_.integrate(maps[next], stops[next].T_map_robot);
  return true;
}

}  // namespace topogeo::map_store
