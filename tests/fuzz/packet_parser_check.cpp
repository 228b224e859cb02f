#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "checks.hpp"
#include "packets/packet_check.hpp"
#include "packets/packet_filter.hpp"
#include "packets/parameter_check.hpp"

namespace topogeo::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kHeader_bytes = 20;

/// Number of submessages that the middleware would read in a packet.
std::size_t submessages(const Bytes& packet) {
  std::size_t count = 0;
  for (std::size_t at = kHeader_bytes; at < packet.size(); ++count) {
    require(packet.size() - at >= 4, "a packet that passes ends with a submessage");
    const bool little = (packet[at + 1] & 1U) != 0;
    const std::size_t size = static_cast<std::size_t>(packet[at + (little ? 2 : 3)]) |
                             packet[at + (little ? 3 : 2)] << 8U;
    const bool may_be_empty = packet[at] == 0x01 || packet[at] == 0x09;
    require(size <= packet.size() - at - 4, "a submessage ends in its packet");
    if (size == 0 && !may_be_empty) return count + 1;
    at += 4 + (size + 3) / 4 * 4;
  }
  return count;
}

/// Walks through a list of parameters like the middleware.
void walk_parameters(const Bytes& payload) {
  const bool little = (payload[1] & 1U) != 0;
  const auto u16 = [&](std::size_t at) {
    return static_cast<unsigned>(payload[at + (little ? 0 : 1)] | payload[at + (little ? 1 : 0)]
                                                                      << 8U);
  };
  for (std::size_t at = 4;;) {
    require(payload.size() - std::min(at, payload.size()) >= 4, "a list that passes has an end");
    const unsigned id = u16(at);
    if (id == 1) return;
    require(id != 0x69 && id != 0x72 && id != 0x75, "no description of a type is left");
    require(u16(at + 2) <= payload.size() - at - 4, "a parameter ends in its list");
    at += 4 + (u16(at + 2) + 3U) / 4 * 4;
  }
}

}  // namespace

std::size_t check_packet_parser(std::string_view text) {
  const Bytes bytes(text.begin(), text.end());
  std::size_t passed = 0;
  for (const bool secured : {false, true}) {
    if (messaging::check_packet(bytes, secured).valid) passed += 1 + submessages(bytes);
    const messaging::PacketFilter filter({.secured = secured});
    const auto admitted = filter.admit(bytes);
    require(admitted.empty() || !filter.admit(Bytes(admitted.begin(), admitted.end())).empty(),
            "what passed passes again");
  }
  Bytes payload = bytes;
  if (messaging::check_parameters(payload)) {
    walk_parameters(payload);
    const Bytes once = payload;
    require(messaging::check_parameters(payload) && payload == once, "what passed passes again");
    ++passed;
  }
  return passed + (messaging::check_handshake(bytes) ? 1 : 0);
}

}  // namespace topogeo::fuzz
