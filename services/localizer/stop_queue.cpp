#include "stop_queue.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::localizer {

namespace {

/// More than a local mapper keeps for late readers (SentMapsLimits).
constexpr std::size_t kMostHashes = 8192;

}  // namespace

StopQueue::Arrival StopQueue::arrival(const topomap::StopId& stop,
                                      std::uint64_t content_hash) const {
  const auto taken = hashes_.find(stop);
  if (taken != hashes_.end()) {
    return content_hash == taken->second ? Arrival::kRepeated : Arrival::kOtherRun;
  }
  if (over_.contains(stop.session)) return Arrival::kRepeated;
  const bool before = last_ && stop.session == last_->session && stop.number <= last_->number;
  return before ? Arrival::kRepeated : Arrival::kNew;
}

void StopQueue::add(MapPointer map) {
  const topomap::StopId stop = map->stop;
  if (over_.contains(stop.session)) return;
  if (std::find(sessions_.begin(), sessions_.end(), stop.session) == sessions_.end()) {
    sessions_.push_back(stop.session);
  }
  waiting_[stop] = std::move(map);
}

StopQueue::MapPointer StopQueue::take() {
  if (last_) {
    if (MapPointer next = take(last_->next())) return next;
  }
  for (const std::uint64_t session : sessions_) {
    if (last_ && session == last_->session) continue;
    if (MapPointer first = take(first_of(session))) return first;
  }
  return nullptr;
}

StopQueue::MapPointer StopQueue::take(const topomap::StopId& stop) {
  const auto found = waiting_.find(stop);
  if (found == waiting_.end()) return nullptr;
  MapPointer map = std::move(found->second);
  waiting_.erase(found);
  if (last_ && last_->session != stop.session) end_session(last_->session);
  hashes_[stop] = topomap::content_hash(*map);
  if (hashes_.size() > kMostHashes) hashes_.erase(hashes_.begin());
  ++taken_;
  last_ = stop;
  return map;
}

topomap::StopId StopQueue::first_of(std::uint64_t session) const {
  const auto first = first_.find(session);
  return {session, first == first_.end() ? 0 : first->second};
}

bool StopQueue::gap_at(const topomap::StopId& stop) const {
  const auto next = waiting_.lower_bound(stop);
  return next != waiting_.end() && next->first.session == stop.session && next->first != stop;
}

std::optional<topomap::StopId> StopQueue::missing() const {
  std::vector<topomap::StopId> wanted;  // any of them may be taken next
  if (last_) wanted.push_back(last_->next());
  for (const std::uint64_t session : sessions_) {
    if (!last_ || session != last_->session) wanted.push_back(first_of(session));
  }
  const auto is_here = [this](const topomap::StopId& stop) { return waiting_.contains(stop); };
  if (std::any_of(wanted.begin(), wanted.end(), is_here)) return std::nullopt;
  const auto gap = std::find_if(wanted.begin(), wanted.end(),
                                [this](const topomap::StopId& stop) { return gap_at(stop); });
  return gap == wanted.end() ? std::nullopt : std::optional(*gap);
}

std::optional<topomap::StopId> StopQueue::missing_at_end() const {
  if (!last_ || !maps_in_session_ || finished() || waiting_.contains(last_->next())) {
    return std::nullopt;
  }
  return last_->next();
}

topomap::StopId StopQueue::begin_late(std::uint64_t session) {
  const auto here = waiting_.lower_bound({session, 0});
  if (here == waiting_.end() || here->first.session != session) return first_of(session);
  first_[session] = here->first.number;
  return here->first;
}

void StopQueue::end_session(std::uint64_t session) {
  over_.insert(session);
  first_.erase(session);
  std::erase(sessions_, session);
  hashes_.clear();
  std::erase_if(waiting_, [&](const auto& entry) { return entry.first.session == session; });
}

bool StopQueue::finished() const {
  const std::uint64_t next = last_ ? std::uint64_t{last_->number} + 1 : 0;
  return maps_in_session_ && next >= *maps_in_session_;
}

}  // namespace topogeo::localizer
