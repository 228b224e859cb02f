// What came in of peers that keep no rules or are none of ours.
#pragma once

#include <cstdint>

namespace topogeo::messaging {

struct StrangerCounts {
  /// Packets kept from the middleware: no RTPS, or something in them that no peer of good will
  /// sends.
  std::uint64_t invalid_packets = 0;
  /// Messages that came plain where security wants them encrypted: a stranger in the name of a
  /// peer. Kept from their reader or writer.
  std::uint64_t unprotected_packets = 0;
  /// What the security plug-ins reported: messages that they could not decode, or not encode for a
  /// peer that is gone, and what they found wrong with certificates.
  std::uint64_t security_errors = 0;
  /// Messages of authenticated peers for robots that their permissions do not name. Not handed
  /// over.
  std::uint64_t denied_samples = 0;
  /// Announcements of readers and writers of topics that topogeo does not have.
  std::uint64_t unknown_topics = 0;
  /// Messages that said that a peer had left, which then went on sending: from a stranger in its
  /// name. None changed anything.
  std::uint64_t forged_removals = 0;
};

/// Of all participants of this process since its start. From any thread.
[[nodiscard]] StrangerCounts stranger_counts();

}  // namespace topogeo::messaging
