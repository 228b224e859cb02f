// Participants that have proven their identity to one of this process, with security.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <set>

namespace topogeo::messaging {

/// The prefix of the identifiers of a participant.
using PeerPrefix = std::array<std::uint8_t, 12>;

/// Bounded. For several threads.
class ProvenPeers {
 public:
  static constexpr std::size_t kMostPeers = 1024;

  void add(const PeerPrefix& peer);
  void remove(const PeerPrefix& peer);
  [[nodiscard]] bool contains(const PeerPrefix& peer) const;

 private:
  mutable std::mutex mutex_;
  std::set<PeerPrefix> peers_;
};

/// The proven peers of this process.
ProvenPeers& proven_peers();

}  // namespace topogeo::messaging
