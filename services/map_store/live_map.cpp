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
    rebuild_until_ = used_.size();
    start_anew();
    return;
  }
}

void LiveMap::renumber(std::uint64_t numbered_since) {
  if (numbered_since == numbered_since_) return;
  numbered_since_ = numbered_since;
  if (used_.empty()) return;
  rebuild_until_ = 0;
  start_anew();
}

void LiveMap::start_anew() {
  builder_ = topomap::GlobalMapBuilder(config_);
  used_.clear();
  ++rebuilds_;
}

bool LiveMap::step(std::span<const topomap::LocalMap> maps,
                   std::span<const topomap::StopPose> stops) {
  const std::size_t next = used_.size();
  if (next >= std::min(maps.size(), stops.size())) return false;
  used_.push_back(stops[next].T_map_robot);
  if (stops[next].located) builder_.integrate(maps[next], stops[next]);
  return true;
}

}  // namespace topogeo::map_store
