// The lease in the announcement of a participant. A short one in a packet of a stranger would end
// the peer, a long one would keep one that has left.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace topogeo::messaging {

/// Bounds for the leases of all services.
constexpr std::uint32_t kShortestLease_s = 10;
constexpr std::uint32_t kLongestLease_s = 120;

/// Bounds the lease in `packet`, whose bytes from `payload_at` up to `payload_end` are a list of
/// parameters that check_parameters() has passed, and adds the shortest one where there is none.
/// `submessage_at`: where the submessage with the list begins. Returns false when the submessage
/// has no room for it.
[[nodiscard]] bool bound_lease(std::vector<std::uint8_t>& packet, std::size_t submessage_at,
                               std::size_t payload_at, std::size_t payload_end);

}  // namespace topogeo::messaging
