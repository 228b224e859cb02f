#include "topogeo/devices/envelope.hpp"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

Bytes two_envelopes() {
  Bytes bytes{'T', 9, 'T'};
  put_envelope(bytes, EnvelopeKind::kReply, Bytes{'T', 'E', 1});
  put_envelope(bytes, EnvelopeKind::kDatagram, Bytes{});
  return bytes;
}

TEST(Envelopes, AreFoundWhereverTheStreamIsCut) {
  const Bytes bytes = two_envelopes();
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    EnvelopeReader reader;
    auto found = reader.read(std::span(bytes).first(cut));
    for (Envelope& envelope : reader.read(std::span(bytes).subspan(cut))) {
      found.push_back(std::move(envelope));
    }
    ASSERT_EQ(found.size(), 2U) << "cut at " << cut;
    EXPECT_EQ(found[0].kind, EnvelopeKind::kReply);
    EXPECT_THAT(found[0].contents, ElementsAre('T', 'E', 1));
    EXPECT_EQ(found[1].kind, EnvelopeKind::kDatagram);
    EXPECT_TRUE(found[1].contents.empty());
    EXPECT_EQ(reader.noise_bytes(), 3U);
  }
}

TEST(Envelopes, ADamagedOneIsDroppedAndCounted) {
  Bytes bytes = two_envelopes();
  bytes[8] ^= 4U;
  EnvelopeReader reader;
  const auto found = reader.read(bytes);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.front().kind, EnvelopeKind::kDatagram);
  EXPECT_GE(reader.bad_checksum(), 1U);
}

TEST(Envelopes, TooLongContentsAreAMistake) {
  Bytes bytes;
  EXPECT_THROW(put_envelope(bytes, EnvelopeKind::kReply, Bytes(65'536)), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::devices
