// Remembers the readers and writers of other processes for a participant that observes.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "topogeo/messaging/discovery.hpp"

#include "security.hpp"

namespace topogeo::messaging {

/// Also reports refusals, like its base class; used for every participant that observes.
class DiscoveryListener final : public RefusalListener {
 public:
  /// `by_robot`: the partitions of peers end with their robots, which are left out.
  explicit DiscoveryListener(bool by_robot = false) : by_robot_(by_robot) {}

  void on_peer(const DiscoveredPeer& peer) override;
  void on_peer_endpoint(const DiscoveredEndpoint& endpoint) override;

  /// The current endpoints, ordered by their ids.
  std::vector<RemoteEndpoint> endpoints() const;
  /// Number of other participants now, with discovery servers.
  std::size_t participants() const;

 private:
  /// Bounds the memory in a flood of strangers' endpoints.
  static constexpr std::size_t kMostEndpoints = 65'536;

  void put(const rtps::GUID_t& id, RemoteEndpoint endpoint);
  void remove(const rtps::GUID_t& id);

  bool by_robot_;
  mutable std::mutex endpoints_mutex_;
  std::map<rtps::GUID_t, RemoteEndpoint> endpoints_;
  std::map<rtps::GuidPrefix_t, std::string> names_;  // of participants
};

}  // namespace topogeo::messaging
