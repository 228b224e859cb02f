#include "fast_dds/removal_log.hpp"

#include <chrono>
#include <cstdint>

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;

RemovalLog::Peer peer(std::uint32_t number) {
  RemovalLog::Peer peer;
  peer.value[10] = static_cast<std::uint8_t>(number >> 8U);
  peer.value[11] = static_cast<std::uint8_t>(number);
  return peer;
}

TEST(RemovalLog, CountsRemovalsOfAPeerThatGoesOn) {
  const RemovalLog::Time start{};
  RemovalLog log;
  EXPECT_EQ(log.heard(peer(1), start), 0U);
  log.removed(peer(1), start);
  log.removed(peer(1), start + milliseconds(1));
  EXPECT_EQ(log.heard(peer(2), start + milliseconds(900)), 0U);
  EXPECT_EQ(log.heard(peer(1), start + milliseconds(900)), 2U);
  EXPECT_EQ(log.heard(peer(1), start + milliseconds(1900)), 0U) << "each once";
}

// The two ways of a packet to a participant have a socket each.
TEST(RemovalLog, APacketThatWasUnderWayProvesNothing) {
  const RemovalLog::Time start{};
  RemovalLog log;
  log.removed(peer(1), start);
  EXPECT_EQ(log.heard(peer(1), start + milliseconds(3)), 0U);
  log.ended(peer(1));
  EXPECT_EQ(log.heard(peer(1), start + milliseconds(900)), 0U);
}

TEST(RemovalLog, AFloodIsBounded) {
  const RemovalLog::Time start{};
  RemovalLog log;
  for (std::uint32_t number = 0; number < RemovalLog::kMostPeers + 10; ++number) {
    log.removed(peer(number), start);
  }
  std::uint64_t forged = 0;
  for (std::uint32_t number = 0; number < RemovalLog::kMostPeers + 10; ++number) {
    forged += log.heard(peer(number), start + milliseconds(900));
  }
  EXPECT_EQ(forged, RemovalLog::kMostPeers);
}

}  // namespace
}  // namespace topogeo::messaging
