// What stands between the network and the parser of Fast DDS 2.9.1: packet_shield.cpp checks a
// packet before it is read, endpoint_shield.cpp what it asks of a reader or a writer.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets the shields linked in.
void shield_packets();

/// Whether this thread works on a packet with submessages that nothing protects.
[[nodiscard]] bool in_unprotected_packet();

}  // namespace topogeo::messaging
