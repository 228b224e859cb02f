// Whether a packet that came in is RTPS as it is sent, before the middleware reads it (Object
// Management Group, DDSI-RTPS 2.3, chapter 9.4). Fast DDS 2.9.1 reads beyond the ends of packets,
// takes memory for counts that a packet states, and repeats loops as often as it asks for, so what
// it does not check is checked here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace topogeo::messaging {

struct PacketCheck {
  bool valid = false;
  /// Has submessages about samples that no envelope of DDS security protects.
  bool unprotected = false;
};

/// `packet` is what a socket received or shared memory held. A submessage of an unknown kind is
/// skipped, as the standard wants. What is inside an envelope of DDS security is not looked at:
/// only authenticated peers can make one that opens.
[[nodiscard]] PacketCheck check_packet(std::span<const std::uint8_t> packet);

}  // namespace topogeo::messaging
