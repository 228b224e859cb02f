#include "map_input.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::map_store {

MapInput::MapInput(Stored stored)
    : local_maps_(std::move(stored.local_maps)),
      first_kept_(std::move(stored.first_kept)),
      closures_(std::move(stored.closures)),
      stored_edges_(std::move(stored.edges)),
      refused_merges_(std::move(stored.refused_merges)) {
  for (const topomap::LocalMap& map : local_maps_) remember(map);
  if (!stored.trajectory.stops.empty()) {
    closures_version_ = stored.trajectory.version;
    for (const auto& segment : service::to_segments(stored.trajectory, {}, 0)) {
      trajectory_.add(segment);
    }
  }
  for (topomap::LocalMap& map : stored.waiting) add(std::move(map));
}

void MapInput::add(const storage::RefusedMerge& refused) {
  if (std::ranges::find(refused_merges_, refused) != refused_merges_.end()) return;
  refused_merges_.push_back(refused);
}

void MapInput::remember(const topomap::LocalMap& map) {
  const topomap::LocalMap as_sent = topomap::numbered(map, map.stop.number, false);
  arrived_.try_emplace(map.stop, Arrived{map.sequence, topomap::content_hash(as_sent)});
  if (std::ranges::find(sessions_, map.stop.session) == sessions_.end()) {
    sessions_.push_back(map.stop.session);
  }
}

MapInput::Arrival MapInput::add(topomap::LocalMap map) {
  const topomap::StopId stop = map.stop;
  if (dropped(stop) && !arrived_.contains(stop)) return Arrival::kKnown;
  const Arrived arrived{map.sequence, topomap::content_hash(map)};
  const auto [held, fresh] = arrived_.try_emplace(stop, arrived);
  if (!fresh) return held->second == arrived ? Arrival::kKnown : Arrival::kDifferent;
  if (std::ranges::find(sessions_, stop.session) == sessions_.end())
    sessions_.push_back(stop.session);
  waiting_.emplace(stop, std::move(map));
  if (renewal_) renew();
  extend();
  drop_old();
  return Arrival::kNew;
}

void MapInput::add(const msg::TrajectorySegment& message) {
  static_cast<void>(service::from_msg(message));  // an invalid message changes no renewal
  if (message.numbered_since() > trajectory_.numbered_since()) {
    renewal_of(message.numbered_since()).trajectory.add(message);
    renew();
    return;
  }
  // The localizer has restarted with the previous numbers.
  if (renewal_ && message.version() >= renewal_numbers_) renewal_.reset();
  if (message.numbered_since() == trajectory_.numbered_since()) check_stops(message);
  trajectory_.add(message);
  extend();
  drop_old();
}

void MapInput::check_stops(const msg::TrajectorySegment& message) const {
  for (const msg::StopPose& stop : message.stops()) {
    if (stop.local_map_id() >= local_maps_.size()) continue;
    const topomap::StopId named = service::from_msg(stop.stop());
    const topomap::StopId held = local_maps_[stop.local_map_id()].stop;
    if (named == held) continue;
    throw std::invalid_argument(
        fmt::format("stop {} of the localizer is stop {} of session {:016x}, but stop {} of "
                    "session {:016x} in this map: the localizer does not extend this map",
                    stop.local_map_id(), named.number, named.session, held.number, held.session));
  }
}

void MapInput::extend() {
  while (const topomap::StopPose* stop = trajectory_.stop(local_maps_.size())) {
    const auto found = waiting_.find(stop->stop);
    if (found == waiting_.end()) return;
    take_in(std::move(waiting_.extract(found).mapped()));
  }
}

void MapInput::take_in(topomap::LocalMap map) {
  const auto id = static_cast<std::uint32_t>(local_maps_.size());
  const bool follows = id == 0 || local_maps_.back().stop.next() == map.stop;
  local_maps_.push_back(topomap::numbered(std::move(map), id, !follows));
  ++edge_changes_;  // earlier edges may become usable now
}

MapInput::Renewal& MapInput::renewal_of(std::uint64_t numbered_since) {
  if (!renewal_ || numbered_since > renewal_numbers_) {
    renewal_.emplace();
    renewal_numbers_ = numbered_since;
  }
  return *renewal_;
}

void MapInput::renew() {
  if (!renewal_->trajectory.complete()) return;
  const topomap::Trajectory trajectory = renewal_->trajectory.newest();
  std::map<topomap::StopId, topomap::LocalMap*> before;
  for (topomap::LocalMap& map : local_maps_) before[map.stop] = &map;
  const topomap::StopId first = trajectory.stops.front().stop;
  if (!before.empty() && !before.contains(first)) {
    renewal_.reset();
    throw std::invalid_argument(
        fmt::format("the renumbered trajectory begins with stop {} of session {:016x}, which is "
                    "not in this map: the localizer does not extend this map",
                    first.number, first.session));
  }
  // A late stop must not remove anything from the map.
  bool late = false;
  for (const topomap::StopPose& stop : trajectory.stops) {
    late |= !before.contains(stop.stop) && !waiting_.contains(stop.stop);
    if (late && before.contains(stop.stop)) return;
  }
  std::vector<topomap::LocalMap> all = std::exchange(local_maps_, {});
  for (const topomap::StopPose& stop : trajectory.stops) {
    const auto joins = waiting_.find(stop.stop);
    const auto stays = before.find(stop.stop);
    if (stays != before.end()) {
      take_in(std::move(*stays->second));
      before.erase(stays);
    } else if (joins != waiting_.end()) {
      take_in(std::move(waiting_.extract(joins).mapped()));
    } else {
      break;
    }
  }
  for (const auto& [stop, map] : before) {
    arrived_.erase(stop);
    std::uint32_t& first_kept = first_kept_[stop.session];
    first_kept = std::max(first_kept, stop.number + 1);
  }
  trajectory_ = std::move(renewal_->trajectory);
  closures_ = std::move(renewal_->closures);
  closures_version_ = renewal_->closures_version;
  stored_edges_.clear();
  edges_ = std::move(renewal_->edges);
  ++edge_changes_;
  renewal_.reset();
  extend();
  drop_old();
}

// The trajectory names the stops of a session in the order of their numbers.
void MapInput::drop_old() {
  if (!local_maps_.empty()) {
    const topomap::StopId last = local_maps_.back().stop;
    auto old = waiting_.lower_bound({last.session, 0});
    while (old != waiting_.end() && old->first < last) drop(old++);
  }
  // Drop from the oldest session that has any.
  for (std::size_t i = 0; waiting_.size() > kMostWaiting && i < sessions_.size();) {
    const auto oldest = waiting_.lower_bound({sessions_[i], 0});
    if (oldest == waiting_.end() || oldest->first.session != sessions_[i]) {
      ++i;
    } else {
      drop(oldest);
    }
  }
}

void MapInput::drop(Waiting::iterator map) {
  const topomap::StopId stop = map->first;
  waiting_.erase(map);
  arrived_.erase(stop);
  first_kept_[stop.session] = stop.number + 1;
  ++dropped_;
}

bool MapInput::dropped(const topomap::StopId& stop) const {
  const auto first = first_kept_.find(stop.session);
  return first != first_kept_.end() && stop.number < first->second;
}

std::optional<topomap::StopId> MapInput::lost() const {
  const topomap::StopPose* const next = trajectory_.stop(local_maps_.size());
  if (next == nullptr || !dropped(next->stop)) return std::nullopt;
  return next->stop;
}

void MapInput::add(const msg::LoopClosures& message) {
  if (message.numbered_since() < trajectory_.numbered_since()) return;
  std::vector<topomap::LoopClosure> received = service::from_msg(message);
  auto* closures = &closures_;
  auto* version = &closures_version_;
  if (message.numbered_since() > trajectory_.numbered_since()) {
    Renewal& renewal = renewal_of(message.numbered_since());
    closures = &renewal.closures;
    version = &renewal.closures_version;
  }
  if (*version && message.version() < **version) return;
  *closures = std::move(received);
  *version = message.version();
}

void MapInput::add(const msg::MapEdges& message) {
  if (message.numbered_since() > trajectory_.numbered_since()) {
    static_cast<void>(service::from_msg(message));
    renewal_of(message.numbered_since()).edges.add(message);
    return;
  }
  if (message.numbered_since() < trajectory_.numbered_since()) return;
  edges_.add(message);
  ++edge_changes_;
}

std::vector<storage::MapEdge> MapInput::usable_edges() const {
  std::vector<storage::MapEdge> out = edges_.newest().value_or(stored_edges_);
  std::erase_if(out,
                [&](const storage::MapEdge& edge) { return edge.later_id >= local_maps_.size(); });
  return out;
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
  if (!end_ || local_maps_.size() < end_->count() || closures_version_ != end_->version() ||
      !edges_.whole(end_->version())) {
    return std::nullopt;
  }
  std::optional<topomap::Trajectory> out = trajectory_.whole(end_->version());
  if (!out || out->stops.size() != end_->count()) return std::nullopt;
  return out;
}

}  // namespace topogeo::map_store
