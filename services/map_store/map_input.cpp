#include "map_input.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/service/conversions.hpp"

namespace topogeo::map_store {

MapInput::MapInput(std::vector<topomap::LocalMap> stored)
    : local_maps_(std::move(stored)), stored_(local_maps_.size()) {}

MapInput::Arrival MapInput::add(topomap::LocalMap map) {
  if (map.id < first_kept_ && !arrived_.contains(map.id)) return Arrival::kKnown;
  const Arrived arrived{map.sequence, topomap::content_hash(map)};
  const auto [held, fresh] = arrived_.try_emplace(map.id, arrived);
  if (!fresh) return held->second == arrived ? Arrival::kKnown : Arrival::kDifferent;
  const std::uint32_t id = map.id;
  waiting_.emplace(id, std::move(map));
  extend();
  drop_old();
  return Arrival::kNew;
}

void MapInput::add(const msg::TrajectorySegment& message) {
  check_sources(message);
  trajectory_.add(message);
  extend();
  drop_old();
}

void MapInput::check_sources(const msg::TrajectorySegment& message) const {
  for (const msg::StopPose& stop : message.stops()) {
    const bool stored = stop.source_id() == topomap::kStoredSource;
    if (stored == (stop.local_map_id() < stored_)) continue;
    throw std::invalid_argument("stop " + std::to_string(stop.local_map_id()) + " is " +
                                (stored ? "" : "not ") + "of a stored map, expected the first " +
                                std::to_string(stored_) +
                                " to be: localizer and map store need the same --continue");
  }
}

void MapInput::extend() {
  while (const topomap::StopPose* stop = trajectory_.stop(local_maps_.size())) {
    const auto found = waiting_.find(stop->source_id);
    if (found == waiting_.end()) return;
    const auto id = static_cast<std::uint32_t>(local_maps_.size());
    const bool follows = last_source_ ? *last_source_ + 1 == stop->source_id : stored_ == 0;
    last_source_ = stop->source_id;
    local_maps_.push_back(
        topomap::numbered(std::move(waiting_.extract(found).mapped()), id, id > 0 && !follows));
  }
}

// The trajectory names its stops in the order of their ids.
void MapInput::drop_old() {
  while (!waiting_.empty() && last_source_ && waiting_.begin()->first < *last_source_) {
    drop_oldest();
  }
  while (waiting_.size() > kMostWaiting) drop_oldest();
}

void MapInput::drop_oldest() {
  const std::uint32_t id = waiting_.begin()->first;
  waiting_.erase(waiting_.begin());
  arrived_.erase(id);
  first_kept_ = id + 1;
  ++dropped_;
}

std::optional<std::uint32_t> MapInput::lost() const {
  const topomap::StopPose* const next = trajectory_.stop(local_maps_.size());
  if (next == nullptr || next->source_id >= first_kept_) return std::nullopt;
  return next->source_id;
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
