// Tests whether discovery can work on the network of this machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "diagnose/machine_facts.hpp"

namespace topogeo::cli {

/// Group of discovery: Object Management Group, DDSI-RTPS 2.3, chapter 9.6.1.4.
inline constexpr const char* kDiscoveryGroup = "239.255.0.1";

struct UdpSocket {
  std::uint32_t port = 0;  ///< port of this machine
  std::string inode;       ///< inode of the socket; empty if the kernel hides it
};

/// All sockets in net/udp and net/udp6 of the kernel.
std::vector<UdpSocket> udp_sockets(const std::filesystem::path& proc);

/// The reason why a UDP port cannot be opened beside the programs that share it; empty if it can.
std::string why_port_cannot_be_shared(std::uint32_t port);

/// "name (process id)" of a program with a socket at the port; empty when it cannot be found, as
/// for programs of other users.
std::string owner_of_udp_port(std::uint32_t port, const std::filesystem::path& proc);

/// Sends a packet to the discovery group on each interface that is up and supports multicast, or on
/// the loopback interface if there is no other, and waits up to a second for it to come back.
std::vector<MulticastProbe> probe_multicast();

/// Bytes that a new UDP socket can buffer; 0 when no socket can be opened.
std::uint64_t receive_buffer_of_a_socket();

/// Whether the routing table (the kernel's net/route) has an entry for the discovery group.
bool has_multicast_route(const std::filesystem::path& route_table);

}  // namespace topogeo::cli
