#include "discovery_listener.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "robot_partitions.hpp"

namespace topogeo::messaging {

namespace {

void leave_robots_out(std::vector<std::string>& partitions) {
  for (std::string& name : partitions) name = partition_without_robot(name);
  std::ranges::sort(partitions);
  partitions.erase(std::unique(partitions.begin(), partitions.end()), partitions.end());
}

}  // namespace

void DiscoveryListener::on_peer(const DiscoveredPeer& peer) {
  {
    const std::lock_guard lock(endpoints_mutex_);
    const rtps::GuidPrefix_t& prefix = peer.id.guidPrefix;
    if (peer.gone) {
      names_.erase(prefix);
      std::erase_if(endpoints_,
                    [&](const auto& entry) { return entry.first.guidPrefix == prefix; });
    } else if (names_.size() < kMostEndpoints) {
      names_[prefix] = peer.name;
    }
  }
  RefusalListener::on_peer(peer);
}

void DiscoveryListener::on_peer_endpoint(const DiscoveredEndpoint& endpoint) {
  if (endpoint.gone) {
    remove(endpoint.id);
  } else {
    put(endpoint.id, endpoint.endpoint);
  }
  RefusalListener::on_peer_endpoint(endpoint);
}

std::vector<RemoteEndpoint> DiscoveryListener::endpoints() const {
  const std::lock_guard lock(endpoints_mutex_);
  std::vector<RemoteEndpoint> all;
  for (const auto& [guid, endpoint] : endpoints_) {
    all.push_back(endpoint);
    const auto name = names_.find(guid.guidPrefix);
    if (name != names_.end()) all.back().participant = name->second;
  }
  return all;
}

std::size_t DiscoveryListener::participants() const {
  const std::lock_guard lock(endpoints_mutex_);
  return names_.size();
}

void DiscoveryListener::put(const rtps::GUID_t& id, RemoteEndpoint endpoint) {
  if (by_robot_) leave_robots_out(endpoint.partitions);
  const std::lock_guard lock(endpoints_mutex_);
  if (endpoints_.size() >= kMostEndpoints && !endpoints_.contains(id)) return;
  endpoints_[id] = std::move(endpoint);
}

void DiscoveryListener::remove(const rtps::GUID_t& id) {
  const std::lock_guard lock(endpoints_mutex_);
  endpoints_.erase(id);
}

}  // namespace topogeo::messaging
