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
  /// Has plain submessages that a participant with security gets encrypted alone.
  bool unprotected = false;
  /// Some of those are about samples of a topic, which go to matched readers and writers only.
  bool unprotected_topic = false;
  /// Has plain samples of discovery or of a handshake.
  bool announces = false;
};

/// `packet` is what a socket received or shared memory held. A submessage of an unknown kind is
/// skipped, as the standard wants. `secured`: whether the participant has security and opens
/// envelopes. Then what is inside one is not looked at: only authenticated peers can make one that
/// opens. Without security envelopes are unknown submessages, between which everything is read.
[[nodiscard]] PacketCheck check_packet(std::span<const std::uint8_t> packet, bool secured);

}  // namespace topogeo::messaging
