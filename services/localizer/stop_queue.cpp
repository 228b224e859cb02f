#include "stop_queue.hpp"

#include <utility>

namespace topogeo::localizer {

StopQueue::Arrival StopQueue::arrival(std::uint32_t id, std::uint64_t content_hash) const {
  if (id >= hashes_.size()) return Arrival::kNew;
  return content_hash == hashes_[id] ? Arrival::kRepeated : Arrival::kOtherRun;
}

void StopQueue::add(MapPointer map) {
  const std::uint32_t id = map->id;
  waiting_[id] = std::move(map);
}

StopQueue::MapPointer StopQueue::take() {
  if (waiting_.empty() || waiting_.begin()->first != hashes_.size()) return nullptr;
  MapPointer map = std::move(waiting_.begin()->second);
  waiting_.erase(waiting_.begin());
  hashes_.push_back(topomap::content_hash(*map));
  return map;
}

}  // namespace topogeo::localizer
