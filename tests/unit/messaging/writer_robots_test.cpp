#include "writer_robots.hpp"

#include <cstdint>

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

/// A writer, or with number 0 the participant itself.
Handle handle(std::uint32_t participant, std::uint8_t number) {
  Handle handle;
  handle.bytes[0] = static_cast<std::uint8_t>(participant & 0xFFU);
  handle.bytes[1] = static_cast<std::uint8_t>(participant >> 8U);
  handle.bytes[15] = number;
  return handle;
}

TEST(WriterRobots, AllowsTheRobotsOfThePartitions) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/anna", "floor/bert"});
  EXPECT_TRUE(robots.allows(handle(1, 1), "anna"));
  EXPECT_TRUE(robots.allows(handle(1, 1), "bert"));
  EXPECT_FALSE(robots.allows(handle(1, 1), "carl"));
  EXPECT_FALSE(robots.allows(handle(1, 2), "anna")) << "another writer of the participant";
  EXPECT_FALSE(robots.allows(handle(2, 1), "anna")) << "another participant";
}

TEST(WriterRobots, AllowsEveryRobotWhereThePartitionsNameNone) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/*"});
  robots.allow(handle(1, 2), {"floor"});
  robots.allow(handle(1, 3), {});
  for (std::uint8_t writer = 1; writer <= 3; ++writer) {
    EXPECT_TRUE(robots.allows(handle(1, writer), "anna")) << int{writer};
  }
}

TEST(WriterRobots, TakesTheLastPartitionsOfAWriter) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/anna"});
  robots.allow(handle(1, 1), {"floor/bert"});
  EXPECT_FALSE(robots.allows(handle(1, 1), "anna"));
  EXPECT_TRUE(robots.allows(handle(1, 1), "bert"));
}

/// Lets so many participants join and leave.
void pass(WriterRobots& robots, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    robots.allow(handle(100 + i, 1), {"floor/anna"});
    robots.depart(handle(100 + i, 0));
  }
}

// The last messages of a peer that has left may still be pending.
TEST(WriterRobots, RemembersThoseThatHaveJustLeft) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/anna"});
  robots.depart(handle(1, 0));
  pass(robots, WriterRobots::kMostDeparted - 1);
  EXPECT_TRUE(robots.allows(handle(1, 1), "anna"));
  pass(robots, WriterRobots::kMostDeparted);
  EXPECT_FALSE(robots.allows(handle(1, 1), "anna"));
}

TEST(WriterRobots, KeepsAParticipantThatComesBack) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/anna"});
  robots.depart(handle(1, 0));
  robots.allow(handle(1, 1), {"floor/anna"});
  pass(robots, WriterRobots::kMostDeparted + 1);
  EXPECT_TRUE(robots.allows(handle(1, 1), "anna"));
}

TEST(WriterRobots, DoesNotCountStrangersThatLeave) {
  WriterRobots robots;
  robots.allow(handle(1, 1), {"floor/anna"});
  robots.depart(handle(1, 0));
  for (std::uint32_t i = 0; i <= WriterRobots::kMostDeparted; ++i)
    robots.depart(handle(100 + i, 0));
  EXPECT_TRUE(robots.allows(handle(1, 1), "anna"));
}

}  // namespace
}  // namespace topogeo::messaging
