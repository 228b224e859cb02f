// RTPS packets of strangers: random ones, and real ones with bytes changed.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "topogeo/support/random.hpp"

namespace topogeo::test {

using Packet = std::vector<std::uint8_t>;

/// Multicast announcements of the participants of a domain.
class Announcements {
 public:
  explicit Announcements(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    const int yes = 1;
    ::setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);  // NOLINT
    ip_mreq group{};
    ::inet_pton(AF_INET, "239.255.0.1", &group.imr_multiaddr);
    ::inet_pton(AF_INET, "127.0.0.1", &group.imr_interface);
    ::setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group);
    group.imr_interface.s_addr = INADDR_ANY;
    ::setsockopt(socket_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group);
    const timeval patience{2, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  Announcements(const Announcements&) = delete;
  Announcements& operator=(const Announcements&) = delete;
  ~Announcements() { ::close(socket_); }

  /// The next announcement; empty when none comes.
  Packet next() {
    Packet packet(65536);
    const ssize_t size = ::recv(socket_, packet.data(), packet.size(), 0);
    packet.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return packet;
  }

 private:
  int socket_;
};

constexpr std::size_t kPrefix_bytes = 12;

/// Replaces the sender's GUID prefix everywhere in the packet.
inline void rename_sender(Packet& packet, const Packet& name) {
  const Packet prefix(packet.begin() + 8, packet.begin() + 8 + kPrefix_bytes);
  for (auto at = packet.begin(); at != packet.end();) {
    at = std::search(at, packet.end(), prefix.begin(), prefix.end());
    if (at != packet.end()) at = std::ranges::copy(name, at).out;
  }
}

/// RTPS packets (Object Management Group, DDSI-RTPS 2.2, chapter 9.4): submessages of all kinds
/// with random bodies, and real announcements with bytes changed.
class Garbage {
 public:
  /// Senders are ever new peers, or those of the `real` packets.
  Garbage(std::vector<Packet> real, bool new_names)
      : real_(std::move(real)), new_names_(new_names) {}

  /// The announcement of a participant that does not exist.
  Packet next_stranger() {
    Packet packet = real_[random_.below(real_.size())];
    rename(packet);
    return packet;
  }

  Packet next() {
    Packet packet = real_[random_.below(real_.size())];
    if (new_names_) rename(packet);
    if (random_.below(3) == 0) {
      change(packet);
      return packet;
    }
    packet.resize(20);
    for (std::uint64_t n = 1 + random_.below(3); n > 0; --n) add_submessage(packet);
    return packet;
  }

 private:
  void rename(Packet& packet) {
    Packet name(kPrefix_bytes);
    std::ranges::generate(name, [this] { return byte(); });
    rename_sender(packet, name);
  }

  void change(Packet& packet) {
    for (std::uint64_t n = 1 + random_.below(8); n > 0; --n) {
      packet[4 + random_.below(packet.size() - 4)] = byte();
    }
    if (random_.below(4) == 0) packet.resize(4 + random_.below(packet.size() - 4));
  }

  void add_submessage(Packet& packet) {
    // PAD, ACKNACK, HEARTBEAT, GAP, the INFO_ kinds, NACK_FRAG, HEARTBEAT_FRAG, DATA, DATA_FRAG
    constexpr std::array<std::uint8_t, 14> kKinds = {0x01, 0x06, 0x07, 0x08, 0x09, 0x0c, 0x0d,
                                                     0x0e, 0x0f, 0x12, 0x13, 0x15, 0x16, 0x30};
    // Readers and writers, of discovery and of user data.
    constexpr std::array<std::uint32_t, 8> kEntities = {0x000100c7, 0x000100c2, 0x000003c7,
                                                        0x000003c2, 0x000004c7, 0x000004c2,
                                                        0x00000107, 0x00000102};
    Packet body(random_.below(200));
    for (std::uint8_t& value : body) value = random_.below(3) == 0 ? byte() : std::uint8_t{0};
    for (const std::size_t at : {std::size_t{0}, std::size_t{4}}) {
      const std::uint32_t entity = htonl(kEntities.at(random_.below(kEntities.size())));
      if (body.size() > at + 12) std::memcpy(&body[at + 4 * random_.below(2)], &entity, 4);
    }
    const std::uint64_t size = random_.below(8) == 0 ? random_.below(65536) : body.size();
    packet.insert(
        packet.end(),
        {kKinds.at(random_.below(kKinds.size())), static_cast<std::uint8_t>(random_.below(16) | 1U),
         static_cast<std::uint8_t>(size), static_cast<std::uint8_t>(size >> 8U)});
    packet.insert(packet.end(), body.begin(), body.end());
  }

  std::uint8_t byte() { return static_cast<std::uint8_t>(random_.below(256)); }

  std::vector<Packet> real_;
  bool new_names_;
  support::Random random_{7};
};

}  // namespace topogeo::test
