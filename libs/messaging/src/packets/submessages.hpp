// The submessages of an RTPS packet (Object Management Group, DDSI-RTPS 2.3, chapter 9.4).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "packet_reader.hpp"

namespace topogeo::messaging {

constexpr std::size_t kRtpsHeader_bytes = 20;
/// Place in the header of the prefix that the identifiers of the sender's endpoints share.
constexpr std::size_t kSenderOffset_bytes = 8;

/// Entity ids of writers that the middleware itself has.
namespace builtin {
constexpr std::uint32_t kParticipants = 0x000100c2;
constexpr std::uint32_t kWriters = 0x000003c2;
constexpr std::uint32_t kReaders = 0x000004c2;
constexpr std::uint32_t kLiveliness = 0x000200c2;
constexpr std::uint32_t kSecureLiveliness = 0xff0200c2;
constexpr std::uint32_t kHandshakes = 0x000201c3;
}  // namespace builtin

struct Submessage {
  enum Kind : std::uint8_t {
    kNone = 0,
    kPad = 0x01,
    kAckNack = 0x06,
    kHeartbeat = 0x07,
    kGap = 0x08,
    kInfoTimestamp = 0x09,
    kInfoSource = 0x0c,
    kInfoDestination = 0x0e,
    kNackFragment = 0x12,
    kHeartbeatFragment = 0x13,
    kData = 0x15,
    kDataFragment = 0x16,
    kSecurePrefix = 0x31,
    kSecurePostfix = 0x32,
    kSecureMessagePrefix = 0x33,
    kSecureMessagePostfix = 0x34,
    kStatistics = 0x80,  // of the vendor of Fast DDS
  };

  std::uint8_t kind = kNone;
  std::uint8_t flags = 0;
  std::span<const std::uint8_t> body;
  std::size_t end = 0;  // where the next one begins, in the packet

  [[nodiscard]] bool flag(unsigned bit) const { return (flags >> bit & 1U) != 0; }
  [[nodiscard]] bool has_payload() const { return flag(2); }  // of DATA
  [[nodiscard]] PacketReader reader() const { return {body, flag(0)}; }
  [[nodiscard]] bool is_sample() const { return kind == kData || kind == kDataFragment; }
};

/// The one that begins at `at`. Its kind is kNone when the packet ends before it does, or goes on
/// where it must not.
[[nodiscard]] Submessage submessage_at(std::span<const std::uint8_t> packet, std::size_t at);

/// Where an envelope of DDS security ends: a prefix, one submessage, a postfix. 0 when there is no
/// end.
[[nodiscard]] std::size_t end_of_envelope(std::span<const std::uint8_t> packet,
                                          const Submessage& prefix);

/// Calls `visit` for each submessage until it returns false. With `skip_envelopes` not for what is
/// inside an envelope. Returns whether all were visited and are whole.
template <class Visit>
bool visit_submessages(std::span<const std::uint8_t> packet, bool skip_envelopes,
                       const Visit& visit) {
  for (std::size_t at = kRtpsHeader_bytes; at < packet.size();) {
    const Submessage submessage = submessage_at(packet, at);
    if (submessage.kind == Submessage::kNone || !visit(submessage)) return false;
    at = submessage.end;
    if (!skip_envelopes || submessage.kind != Submessage::kSecurePrefix) continue;
    at = end_of_envelope(packet, submessage);
    if (at == 0) return false;
  }
  return true;
}

/// The statements of a list of inline parameters.
struct InlineParameters {
  bool valid = false;
  bool removal = false;                    // the instance is disposed of or unregistered
  std::span<const std::uint8_t> key_hash;  // 16 bytes, or none
};

/// Reads the list up to its end.
[[nodiscard]] InlineParameters read_inline_parameters(PacketReader& reader);

/// Writer and addressed reader of DATA, DATA_FRAG, HEARTBEAT, GAP, ACKNACK or NACK_FRAG; zeros when
/// it is too short. An addressed reader of 0: all.
struct Endpoints {
  std::uint32_t reader = 0;
  std::uint32_t writer = 0;
};
[[nodiscard]] Endpoints endpoints_of(const Submessage& submessage);

/// Whether it is a sample of discovery or of a handshake, or a part of one.
[[nodiscard]] bool is_announcement(const Submessage& submessage);

}  // namespace topogeo::messaging
