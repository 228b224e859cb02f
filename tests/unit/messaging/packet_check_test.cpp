// RTPS packets built by hand after DDSI-RTPS 2.3, chapter 9.4: packets that are really sent pass,
// and each way to mislead a parser is refused.
#include "packets/packet_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "packets/parameter_check.hpp"
#include "rtps_bytes.hpp"

namespace topogeo::messaging {
namespace {

bool valid(const std::vector<Bytes>& submessages) {
  return check_packet(packet(submessages), true).valid;
}

bool unprotected(const std::vector<Bytes>& submessages) {
  return check_packet(packet(submessages), true).unprotected;
}

TEST(PacketCheck, WhatIsSentPasses) {
  const Bytes key_and_status =
      joined({parameter(0x70, Bytes(16, 1)), parameter(0x71, Bytes(4, 0))});
  EXPECT_TRUE(valid({}));
  EXPECT_TRUE(
      valid({submessage(0x0e, kLittle, Bytes(12, 1)), submessage(0x09, kLittle, Bytes(8, 1)),
             data(0x04, kPayload), heartbeat(1, 0), heartbeat(5, 9)}));
  EXPECT_TRUE(valid({data(0x02, joined({key_and_status, kEndOfList}))}));
  EXPECT_TRUE(valid({data(0x06, joined({key_and_status, kEndOfList, kPayload}))}));
  EXPECT_TRUE(valid({data(0x08, kPayload)}));
  EXPECT_TRUE(valid({fragment(1, 1, 1000, 2500, 1000), fragment(3, 1, 1000, 2500, 500)}));
  EXPECT_TRUE(valid({gap(3, 4, 0, 0), gap(3, 9, 33, 2), acknack(0, 0, 0), acknack(7, 256, 8)}));
  EXPECT_TRUE(valid({nack_fragment(1, 32, 1)}));
  // An invalidated timestamp, padding, and an unknown kind.
  EXPECT_TRUE(valid({submessage(0x09, 3, {}), submessage(0x01, kLittle, {}),
                     submessage(0x7f, kLittle, Bytes(8, 0xff))}));
}

TEST(PacketCheck, BigEndianIsReadAsSuch) {
  const Bytes body = {0, 0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 0, 0,
                      0, 5, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 1};
  EXPECT_TRUE(valid({joined({{0x07, 0, 0, 28}, body})}));
  Bytes reversed = body;
  std::swap(reversed[15], reversed[23]);  // from 9 to 5
  EXPECT_FALSE(valid({joined({{0x07, 0, 0, 28}, reversed})}));
}

TEST(PacketCheck, HeadersOfOthersAreRefused) {
  const Bytes good = packet({heartbeat(1, 1)});
  EXPECT_TRUE(check_packet(good, true).valid);
  for (const std::size_t at : {0U, 3U, 4U}) {
    Bytes bad = good;
    bad[at] = 1;
    EXPECT_FALSE(check_packet(bad, true).valid) << at;
  }
  EXPECT_FALSE(check_packet(Bytes(good.begin(), good.begin() + 19), true).valid);
  EXPECT_FALSE(check_packet({}, true).valid);
}

TEST(PacketCheck, EveryPacketThatEndsEarlyIsRefused) {
  // A packet without optional parts at its end, so that no shorter one is valid.
  const Bytes good =
      packet({data(0x06, joined({parameter(0x70, Bytes(16, 1)), kEndOfList, kPayload}))});
  for (std::size_t size = 21; size < good.size(); ++size) {
    EXPECT_FALSE(
        check_packet(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)), true)
            .valid)
        << size;
  }
}

TEST(PacketCheck, SequenceNumbersArePositiveAndBounded) {
  constexpr std::int64_t kTooFar = (std::int64_t{1} << 40) + 1;
  for (const std::int64_t bad : {std::int64_t{0}, std::int64_t{-1}, kTooFar}) {
    EXPECT_FALSE(valid({data(0x04, kPayload, bad)})) << bad;
    EXPECT_FALSE(valid({heartbeat(bad, bad)})) << bad;
    EXPECT_FALSE(valid({gap(bad, 5, 0, 0)})) << bad;
    EXPECT_FALSE(valid({gap(5, bad, 0, 0)})) << bad;
  }
  EXPECT_FALSE(valid({heartbeat(1, kTooFar)}));
  EXPECT_FALSE(valid({heartbeat(5, 3)}));
  EXPECT_FALSE(valid({acknack(-1, 0, 0)}));
  EXPECT_FALSE(valid({acknack(kTooFar, 0, 0)}));
}

TEST(PacketCheck, SetsHoldWhatTheyState) {
  EXPECT_FALSE(valid({gap(3, 9, 257, 9)}));
  EXPECT_FALSE(valid({gap(3, 9, 33, 1)}));
  EXPECT_FALSE(valid({acknack(7, 0xffffffff, 8)}));
  EXPECT_FALSE(valid({nack_fragment(0, 32, 1)}));
  EXPECT_FALSE(valid({nack_fragment(1, 64, 0)}));
}

TEST(PacketCheck, FragmentsLieInTheirSample) {
  EXPECT_FALSE(valid({fragment(0, 1, 1000, 2500, 1000)}));
  EXPECT_FALSE(valid({fragment(4, 1, 1000, 2500, 1000)}));
  EXPECT_FALSE(valid({fragment(1, 0, 1000, 2500, 1000)}));
  EXPECT_FALSE(valid({fragment(1, 1, 0, 2500, 1000)}));
  EXPECT_FALSE(valid({fragment(1, 2, 1000, 2500, 1000)}));
  EXPECT_FALSE(valid({fragment(3, 1, 1000, 2500, 499)}));
  EXPECT_FALSE(valid({fragment(1, 1, 1000, 0xffffffff, 1000)}));
}

TEST(PacketCheck, InlineParametersEndInTheirSubmessage) {
  EXPECT_FALSE(valid({data(0x02, parameter(0x70, Bytes(16, 1)))}));  // no end of the list
  EXPECT_FALSE(valid({data(0x02, joined({u16(0x70), u16(400), kEndOfList}))}));  // too long
  EXPECT_FALSE(valid({data(0x02, joined({parameter(0x70, Bytes(8, 1)), kEndOfList}))}));
  EXPECT_FALSE(valid({data(0x02, joined({parameter(0x71, Bytes(8, 1)), kEndOfList}))}));
  // A million filter results.
  EXPECT_FALSE(valid({data(
      0x02, joined({parameter(0x55, joined({u32(1'000'000), u32(0), u32(0)})), kEndOfList}))}));
}

TEST(PacketCheck, PayloadsHaveTheirEncapsulation) {
  EXPECT_FALSE(valid({data(0x04, {})}));
  EXPECT_FALSE(valid({data(0x04, {0, 1, 0})}));
  EXPECT_FALSE(valid({data(0x0c, kPayload)}));  // a sample and a key
  constexpr std::uint32_t kLiveliness = 0x000200c2;
  EXPECT_FALSE(valid({data(0x04, kPayload, 1, kLiveliness)}));
  EXPECT_TRUE(valid({data(0x04, Bytes(28, 0), 1, kLiveliness)}));
}

TEST(PacketCheck, StatisticsOfFastDdsAreAtTheEnd) {
  const Bytes statistics = submessage(0x80, 0, Bytes(56, 0));
  Bytes big_endian = statistics;
  std::swap(big_endian[2], big_endian[3]);
  EXPECT_TRUE(valid({heartbeat(1, 1), big_endian}));
  EXPECT_FALSE(valid({big_endian, heartbeat(1, 1)}));
  // An envelope must not hide them.
  EXPECT_FALSE(valid({submessage(0x33, kLittle, Bytes(16, 0)), big_endian, heartbeat(1, 1)}));
}

TEST(PacketCheck, EnvelopesAreWholeAndSealed) {
  const Bytes prefix = submessage(0x31, kLittle, Bytes(20, 0));
  const Bytes body = submessage(0x30, kLittle, Bytes(40, 9));
  const Bytes postfix = submessage(0x32, kLittle, Bytes(20, 0));
  EXPECT_TRUE(valid({prefix, body, postfix}));
  EXPECT_FALSE(unprotected({prefix, body, postfix}));
  EXPECT_FALSE(unprotected({prefix, data(0x04, kPayload), postfix}));  // signed only
  EXPECT_FALSE(valid({prefix}));
  EXPECT_FALSE(valid({prefix, body}));
  EXPECT_FALSE(valid({prefix, body, body, postfix}));
  EXPECT_FALSE(valid({prefix, prefix, postfix}));
  // A submessage beside an envelope is not inside it.
  EXPECT_TRUE(unprotected({prefix, body, postfix, data(0x04, kPayload)}));
  EXPECT_TRUE(unprotected({data(0x04, kPayload), prefix, body, postfix}));
}

// A participant without security opens no envelope: it reads what stands between two unknown
// submessages.
TEST(PacketCheck, EnvelopesHideNothingFromAParticipantWithoutSecurity) {
  const Bytes prefix = submessage(0x31, kLittle, Bytes(20, 0));
  const Bytes postfix = submessage(0x32, kLittle, Bytes(20, 0));
  const Bytes wrong = packet({prefix, gap(0, 4, 0, 0), postfix});
  EXPECT_TRUE(check_packet(wrong, true).valid) << "nobody without keys can open it";
  EXPECT_FALSE(check_packet(wrong, false).valid);
  EXPECT_TRUE(check_packet(packet({prefix, gap(1, 4, 0, 0), postfix}), false).valid);
  EXPECT_TRUE(check_packet(packet({prefix}), false).valid);
}

// An envelope around a whole packet needs no key, and Fast DDS still parses its contents.
TEST(PacketCheck, AnEnvelopeAroundTheWholePacketProtectsNothing) {
  const Bytes timestamp = submessage(0x09, kLittle, Bytes(8, 0));
  const Bytes prefix = submessage(0x33, kLittle, Bytes(20, 0));
  const Bytes postfix = submessage(0x34, kLittle, Bytes(20, 0));
  for (const std::vector<Bytes>& packet :
       std::vector<std::vector<Bytes>>{{prefix, data(0x04, kPayload)},
                                       {timestamp, prefix, data(0x04, kPayload)},
                                       {timestamp, prefix, data(0x04, kPayload), postfix},
                                       {prefix, submessage(0x30, kLittle, Bytes(40, 9)), postfix},
                                       {timestamp, postfix, heartbeat(1, 1)}}) {
    EXPECT_TRUE(valid(packet));
    EXPECT_TRUE(unprotected(packet));
  }
  // Its contents are checked like any others.
  EXPECT_FALSE(valid({prefix, data(0x04, kPayload, 0)}));
  EXPECT_FALSE(valid({timestamp, prefix, gap(0, 4, 0, 0)}));
}

TEST(PacketCheck, OnlyDiscoveryAndHandshakesNeedNoProtection) {
  EXPECT_FALSE(unprotected({data(0x04, kPayload, 1, kSpdpWriter)}));
  EXPECT_FALSE(unprotected({data(0x04, kPayload, 1, 0x000201c3)}));
  EXPECT_FALSE(unprotected({submessage(0x0e, kLittle, Bytes(12, 1))}));
  for (const Bytes& plain :
       {data(0x04, kPayload), fragment(1, 1, 1000, 2500, 1000), heartbeat(1, 1), gap(3, 4, 0, 0),
        acknack(1, 0, 0), nack_fragment(1, 32, 1)}) {
    EXPECT_TRUE(unprotected({plain}));
  }
  // Peers with security have a plain discovery as well, which has nothing to say.
  EXPECT_FALSE(unprotected({heartbeat(1, 0, kSedpWriter)}));
  EXPECT_TRUE(unprotected({data(0x04, kPayload, 1, kSedpWriter)}));
  EXPECT_TRUE(unprotected({heartbeat(1, 0, 0xff0003c2)})) << "the encrypted one";
}

// ---- parameters of discovery

bool parameters_pass(const std::vector<Bytes>& parameters) {
  Bytes payload = list(parameters);
  return check_parameters(payload);
}

TEST(ParameterCheck, WhatPeersSayOfThemselvesPasses) {
  EXPECT_TRUE(parameters_pass({}));
  EXPECT_TRUE(parameters_pass({
      parameter(0x62, text("localizer")),
      parameter(0x02, joined({u32(20), u32(0)})),
      parameter(0x29, joined({u32(2), text("run-1"), text("")})),
      parameter(0x59, joined({u32(1), text("PARTICIPANT_TYPE"), text("SIMPLE")})),
      parameter(0x2c, joined({u32(3), {1, 2, 3, 0}})),
      parameter(0x73, joined({u32(1), u16(0), u16(0)})),
      parameter(0x1b, joined({u32(0), u32(0x7fffffff), u32(0xffffffff)})),
      parameter(0x35,
                joined({text("a"), text("b"), text("c"), text("id = %0"), u32(1), text("me")})),
      parameter(0x1001, joined({text("DDS:Auth"),
                                u32(1),
                                text("k"),
                                text("v"),
                                u32(1),
                                text("b"),
                                u32(2),
                                {1, 2, 0, 0}})),
      parameter(0x4321, Bytes(8, 0xff)),
  }));
}

TEST(ParameterCheck, CountsAndLengthsStayInTheirParameter) {
  // A partition whose length points beyond the packet, which caused a segmentation fault.
  EXPECT_FALSE(parameters_pass({parameter(0x29, joined({u32(2), u32(0x40000000), text("x")}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x29, joined({u32(0xffffffff), text("x")}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x73, joined({u32(0x20000000), u32(0)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x8006, joined({u32(0x20000000), u32(0), u32(0)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x2c, joined({u32(0xfffffff0), u32(0)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x59, joined({u32(0x10000000), text("a"), text("b")}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x1001, joined({text("a"), u32(0), u32(0x10000000)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x35, joined({text("a"), text("b")}))}));
}

TEST(ParameterCheck, TextsEndWhereTheySay) {
  EXPECT_FALSE(parameters_pass({parameter(0x62, joined({u32(4), {'a', 'b', 'c', 'd'}}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x62, joined({u32(4), {'a', 0, 'c', 0}}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x62, u32(0))}));
  EXPECT_TRUE(parameters_pass({parameter(0x05, text(std::string(255, 'a')))}));
  EXPECT_FALSE(parameters_pass({parameter(0x05, text(std::string(256, 'a')))}));
}

TEST(ParameterCheck, LeasesLast) {
  EXPECT_FALSE(parameters_pass({parameter(0x02, joined({u32(0), u32(0)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x02, joined({u32(0x80000000), u32(0)}))}));
  EXPECT_FALSE(parameters_pass({parameter(0x1b, joined({u32(0), u32(0), u32(1)}))}));
  EXPECT_TRUE(parameters_pass({parameter(0x02, joined({u32(0), u32(0x80000000)}))}));
}

TEST(ParameterCheck, DescriptionsOfTypesAreTakenOut) {
  for (const std::uint32_t id : {0x69U, 0x72U, 0x75U}) {
    Bytes payload = list({parameter(id, Bytes(12, 0xff)), parameter(0x62, text("a"))});
    EXPECT_TRUE(check_parameters(payload));
    EXPECT_EQ(payload, list({parameter(0, Bytes(12, 0xff)), parameter(0x62, text("a"))}));
  }
}

TEST(ParameterCheck, ListsHaveEncapsulationAndEnd) {
  Bytes payload = list({parameter(0x62, text("a"))});
  for (std::size_t size = 0; size < payload.size() - 2; ++size) {
    Bytes part(payload.begin(), payload.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(check_parameters(part)) << size;
  }
  payload[1] = 1;
  EXPECT_FALSE(check_parameters(payload));
}

TEST(HandshakeCheck, CountsStayInTheMessage) {
  const Bytes begin = joined({{0, 1, 0, 0}, Bytes(96, 1), text("dds.sec.auth")});
  const Bytes holder = joined({text("DDS:Auth"), u32(0), u32(1), text("hash"), u32(4), u32(9)});
  EXPECT_TRUE(check_handshake(joined({begin, u32(1), holder})));
  EXPECT_TRUE(check_handshake(joined({begin, u32(0)})));
  EXPECT_FALSE(check_handshake(joined({begin, u32(2), holder})));
  EXPECT_FALSE(check_handshake(joined({begin, u32(0x10000000), holder})));
  EXPECT_FALSE(check_handshake(joined({begin, u32(1), text("DDS:Auth"), u32(0x8000000), u32(0)})));
  EXPECT_FALSE(check_handshake(
      joined({begin, u32(1), text("DDS:Auth"), u32(0), u32(1), text("b"), u32(0xf0000000)})));
  EXPECT_FALSE(check_handshake({}));
}

}  // namespace
}  // namespace topogeo::messaging
