// Which removals of peers were forged: the peer goes on sending.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include <fastdds/rtps/common/GuidPrefix_t.hpp>

namespace topogeo::messaging {

/// Bounded: of a flood of removals those of the first kMostPeers peers are followed. For several
/// threads.
class RemovalLog {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Peer = eprosima::fastrtps::rtps::GuidPrefix_t;

  static constexpr std::size_t kMostPeers = 1024;
  /// A packet may be overtaken by the removal that its peer sent after it, on another socket.
  static constexpr std::chrono::milliseconds kUnderWay{500};

  /// A message says that the peer has left.
  void removed(const Peer& peer, Time now);

  /// A packet of the peer has come. Returns how many removals were forged, by that.
  std::uint64_t heard(const Peer& peer, Time now);

  /// The peer has left: its lease is over.
  void ended(const Peer& peer);

 private:
  struct Removals {
    Time first;
    std::uint64_t count = 0;
  };

  std::mutex mutex_;
  std::map<Peer, Removals> peers_;
  std::atomic<bool> empty_ = true;  // whether peers_ is, for each packet
};

}  // namespace topogeo::messaging
