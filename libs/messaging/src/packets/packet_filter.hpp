// Decides which of the packets that come a participant lets in. Fast DDS 2.9.1
// 1. reads a partition of any length, so a text at any address, and takes memory for the counts of
//    data representations, properties and tokens as a packet states them (packet_check.hpp,
//    parameter_check.hpp);
// 2. believes whatever packet says that a participant has left (CVE-2023-50257), with security,
//    too. A participant ends when it has been silent for its lease. A message that says so, which
//    is plain always, changes nothing: one that leaves has removed its readers and writers before.
//    Clients of a discovery server believe the server, as nobody else reports who has left;
// 3. with security takes plain messages of encrypted topics, and plain announcements of their
//    readers and writers: a stranger who takes the name of a peer writes what the peer may write,
//    and four packets cut a link for good.
// Without security, whoever takes the name of a peer still speaks for it.
#pragma once

#include <cstdint>
#include <span>

namespace topogeo::messaging {

/// Thread-safe.
class PacketFilter {
 public:
  struct Options {
    bool secured = false;            ///< the participant has security
    bool believes_removals = false;  ///< it is a client of a discovery server
  };

  explicit PacketFilter(const Options& options) : options_(options) {}

  /// Returns the bytes that the middleware may read: the packet, a corrected copy that lasts until
  /// this thread's next call, or nothing. Counts what it refuses (topogeo/messaging/strangers.hpp).
  [[nodiscard]] std::span<const std::uint8_t> admit(std::span<const std::uint8_t> packet) const;

 private:
  Options options_;
};

/// A peer's lease is over, or its discovery server has reported that it left.
void peer_ended(std::span<const std::uint8_t, 12> peer);

}  // namespace topogeo::messaging
