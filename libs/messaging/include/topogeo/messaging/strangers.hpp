// Counts of input from peers that break the protocol or do not belong to topogeo.
#pragma once

#include <cstdint>

namespace topogeo::messaging {

struct StrangerCounts {
  /// Packets kept from the middleware: not RTPS, or with contents that no honest peer sends.
  std::uint64_t invalid_packets = 0;
  /// Messages that came plain although security wants them encrypted: a stranger in the name of a
  /// peer. Kept from their reader or writer.
  std::uint64_t unprotected_packets = 0;
  /// Errors that the security plug-ins reported: messages that they could not decode, or not encode
  /// for a peer that is gone, and faults of certificates.
  std::uint64_t security_errors = 0;
  /// Messages of authenticated peers for robots that their permissions do not name. Discarded.
  std::uint64_t denied_samples = 0;
  /// Announcements of readers and writers of topics that topogeo does not have.
  std::uint64_t unknown_topics = 0;
  /// Forged messages in a peer's name that reported it as gone although it went on sending. They
  /// had no effect.
  std::uint64_t forged_removals = 0;
};

/// The counts over all participants of this process since its start. Thread-safe.
[[nodiscard]] StrangerCounts stranger_counts();

}  // namespace topogeo::messaging
