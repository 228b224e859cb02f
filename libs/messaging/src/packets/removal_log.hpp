// Which removals of peers were forged: the peer goes on sending.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include "proven_peers.hpp"

namespace topogeo::messaging {

/// Bounded: of a flood of removals those of the first kMostPeers peers are followed. For several
/// threads.
class RemovalLog {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Peer = PeerPrefix;

  static constexpr std::size_t kMostPeers = 1024;
  /// Packets that a peer sent before it left may come after its removal: on another socket, from
  /// the queue of a process that stood still, or while a machine that is busy takes its time to end
  /// the peer.
  static constexpr std::chrono::milliseconds kUnderWay{2000};
  /// One that has not left goes on: it announces itself once a second. Packets of so many seconds
  /// after that prove it.
  static constexpr unsigned kSeconds = 3;

  /// A message says that the peer has left.
  void removed(const Peer& peer, Time now);

  /// A packet of the peer has come. Returns how many removals are proven to be forged by now.
  std::uint64_t heard(const Peer& peer, Time now);

  /// The peer has left: its lease is over.
  void ended(const Peer& peer);

 private:
  struct Removals {
    Time first;
    std::uint64_t count = 0;
    Time heard;            // when the last second began in which a packet came
    unsigned seconds = 0;  // with a packet, after kUnderWay
  };

  std::mutex mutex_;
  std::map<Peer, Removals> peers_;
  std::atomic<bool> empty_ = true;  // whether peers_ is, for each packet
};

}  // namespace topogeo::messaging
