#include "packet_filter.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

#include "../stranger_counts.hpp"
#include "lease.hpp"
#include "packet_check.hpp"
#include "parameter_check.hpp"
#include "proven_peers.hpp"
#include "removal_log.hpp"
#include "submessages.hpp"

namespace topogeo::messaging {

namespace {

enum class Ruling : std::uint8_t { kRead, kInvalid, kRemoval };

/// Shared by all participants of this process. Never destroyed: the threads of the middleware may
/// outlive static objects.
RemovalLog& removals() {
  static auto* const log = new RemovalLog;  // NOLINT(cppcoreguidelines-owning-memory)
  return *log;
}

PeerPrefix prefix_at(std::span<const std::uint8_t> bytes) {
  PeerPrefix prefix{};
  std::copy_n(bytes.begin(), prefix.size(), prefix.begin());
  return prefix;
}

/// Plain DATA of discovery or of a handshake.
struct Announcement {
  std::uint32_t writer = 0;
  std::size_t submessage_at = 0;  // in the packet
  std::size_t payload_at = 0;
  std::size_t payload_end = 0;
  bool fragment = false;
  bool has_payload = false;
  InlineParameters parameters;
};

Announcement read_announcement(std::span<const std::uint8_t> packet, const Submessage& data) {
  constexpr std::size_t kSubmessageHeader_bytes = 4;
  constexpr std::size_t kFixed_bytes = 20;
  const auto body_at = static_cast<std::size_t>(data.body.data() - packet.data());
  Announcement announcement;
  announcement.writer = endpoints_of(data).writer;
  announcement.submessage_at = body_at - kSubmessageHeader_bytes;
  announcement.fragment = data.kind == Submessage::kDataFragment;
  announcement.has_payload = data.has_payload();
  PacketReader reader = data.reader();
  reader.skip(kFixed_bytes);
  if (data.flag(1)) announcement.parameters = read_inline_parameters(reader);
  announcement.payload_at = body_at + reader.position();
  announcement.payload_end = body_at + data.body.size();
  return announcement;
}

std::vector<Announcement> announcements_in(std::span<const std::uint8_t> packet, bool secured) {
  std::vector<Announcement> found;
  visit_submessages(packet, secured, [&](const Submessage& submessage) {
    if (is_announcement(submessage)) found.push_back(read_announcement(packet, submessage));
    return true;
  });
  return found;
}

/// Changes the packet only behind the beginning of the announcement.
Ruling judge(const Announcement& announcement, std::vector<std::uint8_t>& packet,
             bool believes_removals) {
  // Peers send them whole, and a list can be checked only as a whole.
  if (announcement.fragment) return Ruling::kInvalid;
  const bool of_participant = announcement.writer == builtin::kParticipants;
  if (of_participant && !believes_removals &&
      (announcement.parameters.removal || !announcement.has_payload)) {
    const std::span<const std::uint8_t> key = announcement.parameters.key_hash;
    const std::span<const std::uint8_t> sender = std::span(packet).subspan(kSenderOffset_bytes);
    removals().removed(prefix_at(key.empty() ? sender : key), std::chrono::steady_clock::now());
    return Ruling::kRemoval;
  }
  if (!announcement.has_payload) return Ruling::kRead;
  const std::span<std::uint8_t> payload = std::span(packet).subspan(
      announcement.payload_at, announcement.payload_end - announcement.payload_at);
  if (announcement.writer == builtin::kHandshakes) {
    return check_handshake(payload) ? Ruling::kRead : Ruling::kInvalid;
  }
  if (!check_parameters(payload)) return Ruling::kInvalid;
  if (of_participant && !bound_lease(packet, announcement.submessage_at, announcement.payload_at,
                                     announcement.payload_end)) {
    return Ruling::kInvalid;
  }
  return Ruling::kRead;
}

}  // namespace

std::span<const std::uint8_t> PacketFilter::admit(std::span<const std::uint8_t> packet) const {
  const PacketCheck check = check_packet(packet, options_.secured);
  if (!check.valid) {
    count_invalid_packet();
    return {};
  }
  const PeerPrefix sender = prefix_at(packet.subspan(kSenderOffset_bytes));
  if (options_.secured && check.unprotected) {
    // A peer without keys also sends plain messages of discovery in its own name, but none of a
    // topic, as no reader or writer here matches its own.
    if (check.unprotected_topic || proven_peers().contains(sender)) count_unprotected_packet();
    return {};
  }
  if (check.announces) {
    thread_local std::vector<std::uint8_t> copy;
    copy.assign(packet.begin(), packet.end());
    std::vector<Announcement> announcements = announcements_in(copy, options_.secured);
    // The last one comes first, as a lease that is added moves what is behind it.
    std::ranges::reverse(announcements);
    for (const Announcement& announcement : announcements) {
      const Ruling ruling = judge(announcement, copy, options_.believes_removals);
      if (ruling == Ruling::kInvalid) count_invalid_packet();
      if (ruling != Ruling::kRead) return {};
    }
    packet = copy;
  }
  count_forged_removals(removals().heard(sender, std::chrono::steady_clock::now()));
  return packet;
}

void peer_ended(std::span<const std::uint8_t, 12> peer) {
  const PeerPrefix prefix = prefix_at(peer);
  removals().ended(prefix);
  proven_peers().remove(prefix);
}

}  // namespace topogeo::messaging
