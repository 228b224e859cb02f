// What stands between the network and the parser of Fast DDS 2.9.1: packet_shield.cpp checks a
// packet before it is read, endpoint_shield.cpp what it asks of a reader or a writer.
#pragma once

#include <cstdint>

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets the shields linked in.
void shield_packets();

/// Whether this thread works on a packet with submessages that nothing protects.
[[nodiscard]] bool in_unprotected_packet();

void count_invalid_packet();
void count_unprotected_packet();
void count_security_error();
void count_denied_sample();
void count_forged_removals(std::uint64_t count);

}  // namespace topogeo::messaging
