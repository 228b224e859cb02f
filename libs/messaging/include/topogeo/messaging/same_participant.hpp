// Finds the participant that a reader or writer belongs to.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "topogeo/messaging/events.hpp"

namespace topogeo::messaging {

/// The first 12 bytes of the handle of a reader or writer (RTPS: GUID prefix).
using ParticipantPrefix = std::array<std::uint8_t, 12>;

inline ParticipantPrefix prefix_of(const Handle& endpoint) {
  ParticipantPrefix prefix{};
  std::copy_n(endpoint.bytes.begin(), prefix.size(), prefix.begin());
  return prefix;
}

inline bool same_participant(const Handle& a, const Handle& b) {
  return prefix_of(a) == prefix_of(b);
}

}  // namespace topogeo::messaging
