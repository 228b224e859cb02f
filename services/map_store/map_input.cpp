#include "map_input.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {

MapInput::Arrival MapInput::add(topomap::LocalMap map) {
  const topomap::LocalMap* held = nullptr;
  if (map.id < local_maps_.size()) {
    held = &local_maps_[map.id];
  } else if (const auto found = waiting_.find(map.id); found != waiting_.end()) {
    held = &found->second;
  }
  if (held != nullptr) {
    const bool same = held->sequence == map.sequence &&
                      topomap::content_hash(*held) == topomap::content_hash(map);
    return same ? Arrival::kKnown : Arrival::kDifferent;
  }
  waiting_.emplace(map.id, std::move(map));
  while (!waiting_.empty() && waiting_.begin()->first == local_maps_.size()) {
    local_maps_.push_back(std::move(waiting_.extract(waiting_.begin()).mapped()));
  }
  return Arrival::kNew;
}

void MapInput::add(const msg::TrajectorySegment& message) {
  trajectory_.add(message);
}

void MapInput::add(const msg::LoopClosures& message) {
  if (closures_version_ && message.version() < *closures_version_) return;
  closures_ = service::from_msg(message);
  closures_version_ = message.version();
}

topomap::Trajectory MapInput::newest_trajectory() const {
  topomap::Trajectory out = trajectory_.newest();
  out.stops.resize(std::min(out.stops.size(), local_maps_.size()));
  return out;
}

std::vector<topomap::LoopClosure> MapInput::usable_closures() const {
  std::vector<topomap::LoopClosure> out = closures_;
  std::erase_if(out, [&](const topomap::LoopClosure& closure) {
    return closure.later_id >= local_maps_.size();
  });
  return out;
}

std::optional<topomap::Trajectory> MapInput::final_trajectory() const {
  if (!end_ || local_maps_.size() < end_->count() || closures_version_ != end_->version()) {
    return std::nullopt;
  }
  std::optional<topomap::Trajectory> out = trajectory_.whole(end_->version());
  if (!out || out->stops.size() != end_->count()) return std::nullopt;
  return out;
}

}  // namespace topogeo::map_store
