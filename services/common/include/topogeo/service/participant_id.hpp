// The process that a writer or reader belongs to.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "topogeo/messaging/events.hpp"

namespace topogeo::service {

/// The same for all writers and readers of a participant.
using ParticipantId = std::array<std::uint8_t, 12>;

/// The first 12 bytes of a writer's or reader's handle (RTPS: GUID prefix).
inline ParticipantId participant_of(const messaging::Handle& endpoint) {
  ParticipantId id{};
  std::copy_n(endpoint.bytes.begin(), id.size(), id.begin());
  return id;
}

}  // namespace topogeo::service
