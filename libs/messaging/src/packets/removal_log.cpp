#include "removal_log.hpp"

namespace topogeo::messaging {

void RemovalLog::removed(const Peer& peer, Time now) {
  const std::lock_guard lock(mutex_);
  const auto known = peers_.find(peer);
  if (known != peers_.end()) {
    ++known->second.count;
  } else if (peers_.size() < kMostPeers) {
    peers_[peer] = {now, 1, now, 0};
    empty_ = false;
  }
}

std::uint64_t RemovalLog::heard(const Peer& peer, Time now) {
  if (empty_) return 0;
  const std::lock_guard lock(mutex_);
  const auto known = peers_.find(peer);
  if (known == peers_.end()) return 0;
  Removals& removals = known->second;
  if (now - removals.first < kUnderWay) return 0;
  if (removals.seconds > 0 && now - removals.heard < std::chrono::seconds(1)) return 0;
  removals.heard = now;
  if (++removals.seconds < kSeconds) return 0;
  const std::uint64_t forged = removals.count;
  peers_.erase(known);
  empty_ = peers_.empty();
  return forged;
}

void RemovalLog::ended(const Peer& peer) {
  const std::lock_guard lock(mutex_);
  peers_.erase(peer);
  empty_ = peers_.empty();
}

}  // namespace topogeo::messaging
