// Plain discovery messages that an attacker would send in the name of a peer (Object Management
// Group, DDSI-RTPS 2.3, chapters 8.5 and 9.6).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/messaging/events.hpp"

#include "garbage.hpp"

namespace topogeo::test {

/// Entity ids of a discovery writer and its reader.
struct DiscoveryPair {
  std::array<std::uint8_t, 4> reader;
  std::array<std::uint8_t, 4> writer;
};
constexpr DiscoveryPair kOfParticipants = {{0, 1, 0, 0xc7}, {0, 1, 0, 0xc2}};
constexpr DiscoveryPair kOfWriters = {{0, 0, 3, 0xc7}, {0, 0, 3, 0xc2}};
constexpr DiscoveryPair kOfReaders = {{0, 0, 4, 0xc7}, {0, 0, 4, 0xc2}};

/// Numbers are little-endian.
class ForgedMessages {
 public:
  /// `victim`: a reader or a writer of the peer.
  explicit ForgedMessages(const messaging::Handle& victim)
      : prefix_(victim.bytes.begin(), victim.bytes.begin() + kPrefix_bytes) {}

  /// "The participant has left", in every encoding that a parser may accept.
  std::vector<Packet> removals_of_participant() {
    const Packet guid = participant();
    const Packet key = joined({{0, 3, 0, 0}, parameter(0x50, guid), kEnd});
    const Packet disposed = parameter(0x71, {0, 0, 0, 3});
    const Packet unregistered = parameter(0x71, {0, 0, 0, 2});
    const Packet hash = parameter(0x70, guid);
    return {data(kOfParticipants, kInline, joined({hash, disposed, kEnd})),
            data(kOfParticipants, kInline, joined({hash, unregistered, kEnd})),
            data(kOfParticipants, kInline | kKey, joined({disposed, kEnd, key})),
            data(kOfParticipants, kInline | kKey, joined({hash, disposed, kEnd, key})),
            fragment(joined({hash, disposed, kEnd}), key)};
  }

  /// "The reader or writer has left."
  Packet removal_of_endpoint(const messaging::Handle& endpoint, const DiscoveryPair& pair) {
    const Packet guid(endpoint.bytes.begin(), endpoint.bytes.end());
    return data(pair, kInline,
                joined({parameter(0x70, guid), parameter(0x71, {0, 0, 0, 3}), kEnd}));
  }

  /// "The writer writes another topic."
  Packet other_topic_of(const messaging::Handle& writer) {
    const Packet guid(writer.bytes.begin(), writer.bytes.end());
    const Packet name = {2, 0, 0, 0, 'x', 0, 0, 0};
    return data(kOfWriters, kPayload,
                joined({{0, 3, 0, 0},
                        parameter(0x5a, guid),
                        parameter(0x05, name),
                        parameter(0x07, name),
                        kEnd}));
  }

  /// The participant's announcement, with a lease of 1/128 s and without a lease.
  std::vector<Packet> short_leases(const Packet& announcement) {
    const Packet lease = {0x02, 0, 8, 0};
    const auto found =
        std::search(announcement.begin(), announcement.end(), lease.begin(), lease.end());
    if (found == announcement.end()) return {};
    const auto at = found - announcement.begin();
    Packet brief = announcement;
    std::ranges::copy(Packet{0, 0, 0, 0, 0, 0, 0, 2}, brief.begin() + at + 4);
    Packet none = announcement;
    none[static_cast<std::size_t>(at)] = 0;  // a parameter that is skipped
    set_number(brief);
    set_number(none);
    return {brief, none};
  }

  /// The same packet after a prefix without a key, which pretends that the packet is in an
  /// envelope. Fast DDS skips a prefix that is not the first submessage.
  static Packet in_dummy_envelope(Packet packet) {
    constexpr std::ptrdiff_t kHeader_bytes = 20;
    const Packet no_timestamp = {0x09, 3, 0, 0};
    const Packet prefix = joined({{0x33, 1, 20, 0}, Packet(20, 0)});
    const Packet both = joined({no_timestamp, prefix});
    packet.insert(packet.begin() + kHeader_bytes, both.begin(), both.end());
    return packet;
  }

  /// Whether an announcement is the victim's.
  [[nodiscard]] bool sent(const Packet& announcement) const {
    return announcement.size() > 60 &&
           std::equal(prefix_.begin(), prefix_.end(), announcement.begin() + 8);
  }

 private:
  static constexpr std::uint8_t kInline = 2;
  static constexpr std::uint8_t kPayload = 4;
  static constexpr std::uint8_t kKey = 8;
  static inline const Packet kEnd = {1, 0, 0, 0};

  static Packet joined(const std::vector<Packet>& parts) {
    Packet all;
    for (const Packet& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  static Packet u16(std::size_t value) {
    return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)};
  }

  static Packet parameter(std::uint16_t id, const Packet& value) {
    return joined({u16(id), u16(value.size()), value});
  }

  [[nodiscard]] Packet participant() const { return joined({prefix_, {0, 0, 1, 0xc1}}); }

  /// Higher than all numbers of the peer, or counted from 1 when it sends nothing.
  Packet next_number(const DiscoveryPair& pair) {
    constexpr std::size_t kMoreThanSent = 256;
    const std::size_t number =
        ++numbers_.at(pair.writer[2]) + (pair.writer == kOfParticipants.writer ? kMoreThanSent : 0);
    return joined({{0, 0, 0, 0}, u16(number), {0, 0}});
  }

  void set_number(Packet& announcement) {
    const Packet writer(kOfParticipants.writer.begin(), kOfParticipants.writer.end());
    const auto found =
        std::search(announcement.begin(), announcement.end(), writer.begin(), writer.end());
    if (found != announcement.end()) std::ranges::copy(next_number(kOfParticipants), found + 4);
  }

  [[nodiscard]] Packet packet(std::uint8_t kind, std::uint8_t flags, const Packet& body) const {
    return joined({{'R', 'T', 'P', 'S', 2, 3, 1, 15},
                   prefix_,
                   {kind, static_cast<std::uint8_t>(flags | 1U)},
                   u16(body.size()),
                   body});
  }

  Packet data(const DiscoveryPair& pair, std::uint8_t flags, const Packet& rest) {
    return packet(0x15, flags,
                  joined({{0, 0, 16, 0},
                          {pair.reader.begin(), pair.reader.end()},
                          {pair.writer.begin(), pair.writer.end()},
                          next_number(pair),
                          rest}));
  }

  /// A single fragment of a sample that is a key.
  Packet fragment(const Packet& parameters, const Packet& key) {
    const DiscoveryPair& pair = kOfParticipants;
    return packet(0x16, kInline | 4U,
                  joined({{0, 0, 28, 0},
                          {pair.reader.begin(), pair.reader.end()},
                          {pair.writer.begin(), pair.writer.end()},
                          next_number(pair),
                          {1, 0, 0, 0, 1, 0},
                          u16(key.size()),
                          u16(key.size()),
                          {0, 0},
                          parameters,
                          key}));
  }

  Packet prefix_;
  std::array<std::size_t, 5> numbers_{};  // by the third byte of a writer
};

}  // namespace topogeo::test
