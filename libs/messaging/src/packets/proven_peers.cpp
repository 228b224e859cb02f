#include "proven_peers.hpp"

namespace topogeo::messaging {

void ProvenPeers::add(const PeerPrefix& peer) {
  const std::lock_guard lock(mutex_);
  if (peers_.size() < kMostPeers) peers_.insert(peer);
}

void ProvenPeers::remove(const PeerPrefix& peer) {
  const std::lock_guard lock(mutex_);
  peers_.erase(peer);
}

bool ProvenPeers::contains(const PeerPrefix& peer) const {
  const std::lock_guard lock(mutex_);
  return peers_.contains(peer);
}

ProvenPeers& proven_peers() {
  // Never destroyed: the threads of the middleware may outlive static objects.
  static auto* const peers = new ProvenPeers;  // NOLINT(cppcoreguidelines-owning-memory)
  return *peers;
}

}  // namespace topogeo::messaging
