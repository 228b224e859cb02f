#include "packets/removal_log.hpp"

#include <chrono>
#include <cstdint>

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;

RemovalLog::Peer peer(std::uint32_t number) {
  RemovalLog::Peer peer{};
  peer[10] = static_cast<std::uint8_t>(number >> 8U);
  peer[11] = static_cast<std::uint8_t>(number);
  return peer;
}

/// Number of forged removals that the log finds when packets of the peer continue, five a second,
/// between two times.
std::uint64_t forged_between(RemovalLog& log, const RemovalLog::Peer& peer, RemovalLog::Time from,
                             RemovalLog::Time to) {
  std::uint64_t forged = 0;
  for (RemovalLog::Time now = from; now <= to; now += milliseconds(200)) {
    forged += log.heard(peer, now);
  }
  return forged;
}

TEST(RemovalLog, CountsRemovalsOfAPeerThatGoesOn) {
  const RemovalLog::Time start{};
  RemovalLog log;
  EXPECT_EQ(log.heard(peer(1), start), 0U);
  log.removed(peer(1), start);
  log.removed(peer(1), start + milliseconds(1));
  EXPECT_EQ(forged_between(log, peer(2), start, start + milliseconds(9000)), 0U);
  EXPECT_EQ(forged_between(log, peer(1), start, start + milliseconds(3900)), 0U);
  EXPECT_EQ(forged_between(log, peer(1), start + milliseconds(4000), start + milliseconds(9000)),
            2U)
      << "each once";
}

// A frozen service ends when it continues, and its peers still read packets from their sockets.
TEST(RemovalLog, PacketsOfAPeerThatIsAboutToEndProveNothing) {
  const RemovalLog::Time start{};
  RemovalLog log;
  log.removed(peer(1), start);
  EXPECT_EQ(forged_between(log, peer(1), start, start + milliseconds(3000)), 0U);
  log.ended(peer(1));
  EXPECT_EQ(forged_between(log, peer(1), start, start + milliseconds(9000)), 0U);
}

TEST(RemovalLog, ABurstOfLatePacketsProvesNothing) {
  const RemovalLog::Time start{};
  RemovalLog log;
  log.removed(peer(1), start);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(log.heard(peer(1), start + milliseconds(6000) + std::chrono::microseconds(i)), 0U);
  }
}

TEST(RemovalLog, AFloodIsBounded) {
  const RemovalLog::Time start{};
  RemovalLog log;
  for (std::uint32_t number = 0; number < RemovalLog::kMostPeers + 10; ++number) {
    log.removed(peer(number), start);
  }
  std::uint64_t forged = 0;
  for (std::uint32_t number = 0; number < RemovalLog::kMostPeers + 10; ++number) {
    forged += forged_between(log, peer(number), start, start + milliseconds(5000));
  }
  EXPECT_EQ(forged, RemovalLog::kMostPeers);
}

}  // namespace
}  // namespace topogeo::messaging
