// The packets that a participant lets in, one by one; those that reach a running one are tested in
// tests/faults.
#include "packets/packet_filter.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/messaging/strangers.hpp"

#include "packets/lease.hpp"
#include "packets/proven_peers.hpp"
#include "rtps_bytes.hpp"

namespace topogeo::messaging {
namespace {

constexpr std::uint32_t kHandshakes = 0x000201c3;
constexpr std::uint8_t kWithParameters = 0x02;
constexpr std::uint8_t kWithPayload = 0x04;
constexpr std::uint8_t kWithKey = 0x08;

Bytes admitted(const Bytes& packet, const PacketFilter::Options& options = {}) {
  const auto bytes = PacketFilter(options).admit(packet);
  return {bytes.begin(), bytes.end()};
}

Bytes lease(std::uint32_t whole_s, std::uint32_t fraction = 0) {
  return parameter(0x02, joined({u32(whole_s), u32(fraction)}));
}

Bytes announced(const std::vector<Bytes>& parameters, std::uint32_t writer = kSpdpWriter) {
  return data(kWithPayload, list(parameters), 1, writer);
}

/// The sender of packet().
PeerPrefix sender() {
  PeerPrefix prefix{};
  for (std::size_t at = 0; at < prefix.size(); ++at) prefix[at] = static_cast<std::uint8_t>(at + 1);
  return prefix;
}

TEST(PacketFilter, OrdinaryPacketsPassAsTheyAre) {
  const Bytes sample = packet({data(kWithPayload, kPayload), heartbeat(1, 1)});
  EXPECT_EQ(admitted(sample), sample);
  const Bytes announcement =
      packet({announced({parameter(0x62, text("a")), lease(10)}), announced({}, kSedpWriter)});
  EXPECT_EQ(admitted(announcement), announcement);
}

TEST(PacketFilter, WhatCannotBeReadIsCounted) {
  const Bytes endless = parameter(0x29, joined({u32(1), u32(0x40000000), text("x")}));
  Bytes fragments = fragment(1, 1, 8, 8, 8);
  std::ranges::copy(entity(kSpdpWriter), fragments.begin() + 12);
  for (const Bytes& wrong :
       {Bytes{1, 2, 3}, packet({gap(0, 1, 0, 0)}), packet({announced({endless})}),
        packet({announced({endless}, kSedpWriter)}), packet({fragments}),
        packet({data(kWithPayload, kPayload, 1, kHandshakes)}),
        packet({heartbeat(1, 1), announced({lease(10)}), announced({endless}, kSedpWriter)})}) {
    const std::uint64_t before = stranger_counts().invalid_packets;
    EXPECT_TRUE(admitted(wrong).empty());
    EXPECT_EQ(stranger_counts().invalid_packets, before + 1);
  }
}

TEST(PacketFilter, DescriptionsOfTypesAreTakenOut) {
  const Bytes told = announced({parameter(0x75, Bytes(12, 0xff)), lease(10)}, kSedpWriter);
  const Bytes untold = announced({parameter(0, Bytes(12, 0xff)), lease(10)}, kSedpWriter);
  EXPECT_EQ(admitted(packet({told})), packet({untold}));
}

TEST(PacketFilter, LeasesAreBounded) {
  const auto bounded = [](const Bytes& announced_lease) {
    return admitted(packet({announced({announced_lease})}));
  };
  EXPECT_EQ(bounded(lease(0, 0x4000000)), packet({announced({lease(kShortestLease_s)})}));
  EXPECT_EQ(bounded(lease(10, 5)), packet({announced({lease(10, 5)})}));
  EXPECT_EQ(bounded(lease(30)), packet({announced({lease(30)})}));
  EXPECT_EQ(bounded(lease(120, 1)), packet({announced({lease(kLongestLease_s)})}));
  EXPECT_EQ(bounded(lease(0x7fffffff, 0xffffffff)), packet({announced({lease(kLongestLease_s)})}));
}

TEST(PacketFilter, AnAnnouncementWithoutALeaseGetsOne) {
  const Bytes name = parameter(0x62, text("a"));
  const Bytes with = packet({announced({lease(kShortestLease_s), name}),
                             announced({lease(kShortestLease_s)}), heartbeat(1, 1)});
  EXPECT_EQ(admitted(packet({announced({name}), announced({}), heartbeat(1, 1)})), with);
  // One that goes up to the end of the packet.
  Bytes open = packet({announced({name})});
  Bytes open_with = packet({announced({lease(kShortestLease_s), name})});
  for (Bytes* bytes : {&open, &open_with}) (*bytes)[22] = (*bytes)[23] = 0;
  EXPECT_EQ(admitted(open), open_with);
}

TEST(PacketFilter, NobodySaysThatAParticipantHasLeft) {
  const Bytes hash = parameter(0x70, Bytes(16, 9));
  const Bytes disposed = parameter(0x71, {0, 0, 0, 1});
  const Bytes unregistered = parameter(0x71, {0, 0, 0, 2});
  const std::uint64_t before = stranger_counts().invalid_packets;
  for (const Bytes& removal :
       {data(kWithParameters, joined({hash, disposed, kEndOfList}), 1, kSpdpWriter),
        data(kWithParameters, joined({unregistered, kEndOfList}), 1, kSpdpWriter),
        data(kWithParameters | kWithKey, joined({disposed, kEndOfList, kPayload}), 1, kSpdpWriter),
        data(kWithParameters | kWithPayload, joined({disposed, kEndOfList, list({lease(10)})}), 1,
             kSpdpWriter),
        data(kWithKey, kPayload, 1, kSpdpWriter)}) {
    EXPECT_TRUE(admitted(packet({removal})).empty());
  }
  const Bytes of_server =
      packet({data(kWithParameters, joined({hash, disposed, kEndOfList}), 1, kSpdpWriter)});
  EXPECT_EQ(admitted(of_server, {.believes_removals = true}), of_server);
  // A reader or a writer that ends says so itself.
  const Bytes of_writer =
      packet({data(kWithParameters, joined({hash, disposed, kEndOfList}), 1, kSedpWriter)});
  EXPECT_EQ(admitted(of_writer), of_writer);
  EXPECT_EQ(stranger_counts().invalid_packets, before) << "honest peers say that they leave";
}

TEST(PacketFilter, WithSecurityOnlyAnnouncementsAndHandshakesArePlain) {
  const PacketFilter::Options secured{.secured = true};
  const Bytes prefix = submessage(0x31, kLittle, Bytes(20, 0));
  const Bytes body = submessage(0x30, kLittle, Bytes(40, 9));
  const Bytes postfix = submessage(0x32, kLittle, Bytes(20, 0));
  for (const Bytes& passes : {packet({prefix, body, postfix}), packet({announced({lease(10)})}),
                              packet({heartbeat(1, 0, kSedpWriter)})}) {
    EXPECT_EQ(admitted(passes, secured), passes);
  }
  const auto refused = [&](const Bytes& plain) {
    const std::uint64_t before = stranger_counts().unprotected_packets;
    EXPECT_TRUE(admitted(plain, secured).empty());
    return stranger_counts().unprotected_packets - before;
  };
  const Bytes sample = packet({data(kWithPayload, kPayload)});
  const Bytes writer = packet({announced({}, kSedpWriter)});
  EXPECT_EQ(refused(writer), 0U) << "in the own name of somebody without keys";
  EXPECT_EQ(refused(sample), 1U) << "nobody sends it to whom he does not know";
  EXPECT_EQ(refused(packet({heartbeat(1, 0)})), 1U);
  proven_peers().add(sender());
  EXPECT_EQ(refused(sample), 1U);
  EXPECT_EQ(refused(writer), 1U);
  EXPECT_EQ(refused(packet({prefix, body, postfix, data(kWithPayload, kPayload)})), 1U);
  const PeerPrefix gone = sender();
  peer_ended(gone);
  EXPECT_EQ(refused(writer), 0U);
}

}  // namespace
}  // namespace topogeo::messaging
