// Counts of input from peers that break the protocol or do not belong to topogeo.
#pragma once

#include <cstdint>

namespace topogeo::messaging {

struct StrangerCounts {
  /// Packets that are not RTPS, or have contents that no honest peer sends; dropped before the
  /// middleware reads them.
  std::uint64_t invalid_packets = 0;
  /// Plain messages in the name of a peer whose messages must be encrypted: a stranger sent them.
  /// They do not reach their reader or writer.
  std::uint64_t unprotected_packets = 0;
  /// Errors of the security plug-ins: messages that they could not decode, messages that they could
  /// not encode because the peer has left, and invalid certificates.
  std::uint64_t security_errors = 0;
  /// Discarded messages of authenticated peers, for robots that their permissions do not name.
  std::uint64_t denied_samples = 0;
  /// Announcements of readers and writers of topics that topogeo does not have.
  std::uint64_t unknown_topics = 0;
  /// Forged messages that reported a peer as gone while it went on sending; they had no effect.
  std::uint64_t forged_removals = 0;
};

/// The counts over all participants of this process since its start. Thread-safe.
[[nodiscard]] StrangerCounts stranger_counts();

}  // namespace topogeo::messaging
