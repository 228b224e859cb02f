#include "localizer/stop_queue.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace topogeo::localizer {
namespace {

using Arrival = StopQueue::Arrival;

constexpr std::uint64_t kSession = 7;
constexpr std::uint64_t kLater = 3;

StopQueue::MapPointer queued_map(std::uint32_t id, std::uint64_t session = kSession) {
  auto map = std::make_shared<topomap::LocalMap>();
  map->robot_id = "robot";
  map->id = id;
  map->stop = {session, id};
  return map;
}

TEST(StopQueue, GivesLocalMapsInTheOrderOfTheirIds) {
  StopQueue queue;
  queue.add(queued_map(1));
  EXPECT_EQ(queue.take(), nullptr) << "map 0 has not come";
  queue.add(queued_map(0));
  EXPECT_EQ(queue.take()->id, 0U);
  EXPECT_EQ(queue.take()->id, 1U);
  EXPECT_EQ(queue.take(), nullptr);
  EXPECT_EQ(queue.taken(), 2U);
}

TEST(StopQueue, DistinguishesARepeatedMapFromThatOfAnotherRun) {
  StopQueue queue;
  const StopQueue::MapPointer map = queued_map(0);
  const std::uint64_t hash = topomap::content_hash(*map);
  EXPECT_EQ(queue.arrival({kSession, 0}, hash), Arrival::kNew);
  queue.add(map);
  EXPECT_EQ(queue.arrival({kSession, 0}, hash + 1), Arrival::kNew)
      << "one that waits may be replaced";
  ASSERT_NE(queue.take(), nullptr);
  EXPECT_EQ(queue.arrival({kSession, 0}, hash), Arrival::kRepeated);
  EXPECT_EQ(queue.arrival({kSession, 0}, hash + 1), Arrival::kOtherRun);
  EXPECT_EQ(queue.arrival({kSession, 1}, hash), Arrival::kNew);
}

TEST(StopQueue, RemembersTheLastOfALongDriveOnly) {
  constexpr std::uint32_t kMany = 8200;
  StopQueue queue;
  for (std::uint32_t i = 0; i < kMany; ++i) {
    queue.add(queued_map(i));
    ASSERT_NE(queue.take(), nullptr);
  }
  const std::uint64_t other = topomap::content_hash(*queued_map(kMany));
  EXPECT_EQ(queue.arrival({kSession, kMany - 1}, other), Arrival::kOtherRun);
  EXPECT_EQ(queue.arrival({kSession, 0}, other), Arrival::kRepeated);
  EXPECT_EQ(queue.arrival({kSession, kMany}, other), Arrival::kNew);
}

TEST(StopQueue, NamesTheStopThatItWaitsForInVain) {
  StopQueue queue;
  EXPECT_FALSE(queue.missing());
  queue.add(queued_map(5));
  EXPECT_EQ(queue.missing(), (topomap::StopId{kSession, 0}));
  queue.add(queued_map(0));
  EXPECT_FALSE(queue.missing()) << "it has something to do";
  queue.take();
  EXPECT_EQ(queue.missing(), (topomap::StopId{kSession, 1}));
  queue.add(queued_map(1));
  queue.take();
  EXPECT_EQ(queue.missing(), (topomap::StopId{kSession, 2}));
  queue.add(queued_map(0, kLater));
  EXPECT_FALSE(queue.missing()) << "another session can begin";
}

TEST(StopQueue, NamesTheStopThatAnEndedStreamStillOwes) {
  StopQueue queue;
  queue.end_at(3);
  EXPECT_FALSE(queue.missing_at_end()) << "nothing has come: not known of which session";
  queue.add(queued_map(0));
  queue.add(queued_map(1));
  queue.take();
  EXPECT_FALSE(queue.missing_at_end()) << "it has something to do";
  queue.take();
  EXPECT_EQ(queue.missing_at_end(), (topomap::StopId{kSession, 2}));
  EXPECT_FALSE(queue.missing()) << "no later one is here";
  queue.add(queued_map(2));
  queue.take();
  EXPECT_FALSE(queue.missing_at_end());
}

TEST(StopQueue, BeginsASessionLateWhenItIsTo) {
  StopQueue queue;
  EXPECT_EQ(queue.begin_late(kSession), (topomap::StopId{kSession, 0})) << "nothing is here";
  queue.add(queued_map(5));
  queue.add(queued_map(6));
  queue.add(queued_map(9));
  EXPECT_EQ(queue.begin_late(kSession), (topomap::StopId{kSession, 5}));
  EXPECT_FALSE(queue.missing());
  EXPECT_EQ(queue.take()->id, 5U);
  EXPECT_EQ(queue.take()->id, 6U);
  EXPECT_EQ(queue.take(), nullptr);
  EXPECT_EQ(queue.missing(), (topomap::StopId{kSession, 7})) << "one that is on has no gaps";
  EXPECT_EQ(queue.arrival({kSession, 3}, 1), Arrival::kRepeated) << "it comes too late";
  queue.end_at(7);
  EXPECT_TRUE(queue.finished());
}

TEST(StopQueue, GoesOverToASessionThatCameLater) {
  StopQueue queue;
  queue.add(queued_map(0));
  queue.add(queued_map(0, kLater));
  queue.add(queued_map(1));
  EXPECT_EQ(queue.take()->stop, (topomap::StopId{kSession, 0}));
  EXPECT_EQ(queue.take()->stop, (topomap::StopId{kSession, 1})) << "the one that is on comes first";
  EXPECT_EQ(queue.take()->stop, (topomap::StopId{kLater, 0}));
  queue.add(queued_map(2));
  EXPECT_EQ(queue.take(), nullptr) << "a session that was left is over";
  EXPECT_EQ(queue.arrival({kSession, 9}, 1), StopQueue::Arrival::kRepeated);
  queue.add(queued_map(1, kLater));
  EXPECT_EQ(queue.take()->stop, (topomap::StopId{kLater, 1}));
  EXPECT_EQ(queue.taken(), 4U);
}

TEST(StopQueue, GoesOnAfterAStopOfAMapThatIsThere) {
  StopQueue queue;
  queue.start_after({kSession, 5});
  EXPECT_EQ(queue.arrival({kSession, 5}, 1), Arrival::kRepeated);
  EXPECT_EQ(queue.arrival({kSession, 6}, 1), Arrival::kNew);
  queue.add(queued_map(6));
  EXPECT_EQ(queue.take()->stop.number, 6U);
  queue.end_at(7);
  EXPECT_TRUE(queue.finished());
}

TEST(StopQueue, IsFinishedWhenAllOfTheStreamHaveBeenTaken) {
  StopQueue queue;
  queue.add(queued_map(0));
  EXPECT_FALSE(queue.finished()) << "the stream has not ended";
  queue.end_at(1);
  EXPECT_FALSE(queue.finished()) << "one waits";
  ASSERT_NE(queue.take(), nullptr);
  EXPECT_TRUE(queue.finished());
}

TEST(StopQueue, AnEmptyStreamIsFinishedAtOnce) {
  StopQueue queue;
  queue.end_at(0);
  EXPECT_TRUE(queue.finished());
}

}  // namespace
}  // namespace topogeo::localizer
