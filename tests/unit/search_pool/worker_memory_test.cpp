// Contents of a worker's memory, and its limit.
#include <string>

#include <gtest/gtest.h>

#include "topogeo/search_pool/map_cache.hpp"
#include "topogeo/search_pool/slot_matchers.hpp"

#include "worker_fixture.hpp"

namespace topogeo::search_pool {
namespace {

TEST(BytesOf, CountsWhatTheMapHolds) {
  topomap::LocalMap map;
  const std::size_t empty = bytes_of(map);
  EXPECT_GE(empty, sizeof(topomap::LocalMap));
  map.points.resize(100);
  map.points.shrink_to_fit();
  EXPECT_EQ(bytes_of(map), empty + 800);
  map.branches.resize(1);
  map.branches.shrink_to_fit();
  map.branches[0].points.resize(10);
  map.branches[0].points.shrink_to_fit();
  EXPECT_EQ(bytes_of(map),
            empty + 800 + sizeof(topomap::LocalBranch) + 10 * sizeof(topomap::BranchPoint));
}

TEST(MapCache, KeepsMapsOfOneIdWithOtherContentApart) {
  MapCache cache(1U << 20U);
  const MapPointer one = room(3, 0.0);
  const MapPointer other = room(3, 0.1);
  cache.add(topomap::content_hash(*one), one);
  cache.add(topomap::content_hash(*other), other);
  EXPECT_EQ(cache.size(), 2U);
  EXPECT_EQ(cache.find(topomap::content_hash(*one)), one);
  EXPECT_EQ(cache.find(topomap::content_hash(*other)), other);
  EXPECT_EQ(cache.find(1), nullptr);
}

TEST(MapCache, TheSameMapAgainTakesNothing) {
  MapCache cache(1U << 20U);
  cache.add(7, room(0, 0.0));
  const std::size_t bytes = cache.bytes();
  cache.add(7, room(0, 0.0));
  EXPECT_EQ(cache.bytes(), bytes);
  EXPECT_EQ(cache.size(), 1U);
}

TEST(MapCache, DropsTheLeastRecentlyUsedMaps) {
  const std::size_t each = bytes_of(*room(0, 0.0));
  MapCache cache(3 * each + each / 2);
  for (std::uint32_t i = 0; i < 3; ++i) cache.add(i, room(i, 0.0));
  EXPECT_NE(cache.find(0), nullptr);  // now 1 is the oldest
  cache.add(3, room(3, 0.0));
  EXPECT_EQ(cache.find(1), nullptr);
  EXPECT_NE(cache.find(0), nullptr);
  EXPECT_NE(cache.find(2), nullptr);
  EXPECT_NE(cache.find(3), nullptr);
  EXPECT_EQ(cache.bytes(), 3 * each);
  EXPECT_EQ(cache.dropped(), 1U);
}

TEST(MapCache, KeepsTheLastMapHoweverLargeAndADroppedOneLivesOnWithItsUsers) {
  MapCache cache(1);
  const MapPointer first = room(0, 0.0);
  cache.add(0, first);
  EXPECT_EQ(cache.find(0), first);
  cache.add(1, room(1, 0.0));
  EXPECT_EQ(cache.size(), 1U);
  EXPECT_EQ(first->points.size(), 180U);
}

class SlotMatchersTest : public ::testing::Test {
 protected:
  void expect_right(SlotMatchers& matchers, const ReadyJob& job) {
    localization::Matcher matcher;
    matcher.add_map(*job.reference);
    matcher.add_map(*job.query);
    EXPECT_TRUE(same(matchers.solve(job), matcher.solve(job.job.task)));
  }
};

TEST_F(SlotMatchersTest, ClientsWithOtherMapsOfTheSameIdsDoNotDisturbEachOther) {
  SlotMatchers matchers(std::size_t{64} << 20U);
  for (std::uint64_t i = 0; i < 3; ++i) {
    expect_right(matchers, ready_job(room(0, 0.0), room(1, 0.2), i, "one"));
    expect_right(matchers, ready_job(room(0, 0.1), room(1, 0.4), i, "other"));
  }
  EXPECT_EQ(matchers.size(), 2U);
  EXPECT_EQ(matchers.maps(), 4U) << "features are made once";
}

TEST_F(SlotMatchersTest, StaysWithinItsMemoryWithEverNewClients) {
  constexpr std::size_t kCapacity_bytes = std::size_t{8} << 20U;
  SlotMatchers matchers(kCapacity_bytes);
  for (std::uint64_t i = 0; i < 12; ++i) {
    expect_right(matchers, ready_job(room(0, 0.0), room(1, 0.2), i, std::to_string(i)));
    EXPECT_LE(matchers.bytes(), kCapacity_bytes);
    EXPECT_GE(matchers.size(), 1U);
  }
}

TEST_F(SlotMatchersTest, StaysWithinItsMemoryWithEverNewMapsOfOneClient) {
  constexpr std::size_t kCapacity_bytes = std::size_t{8} << 20U;
  SlotMatchers matchers(kCapacity_bytes);
  bool started_anew = false;
  std::size_t most = 0;
  for (std::uint32_t i = 0; i < 500; ++i) {
    ReadyJob next = ready_job(room(2 * i, 0.0), room(2 * i + 1, 0.2), i);
    next.job.task.genetic.generations = 1;
    next.job.task.genetic.individuals = 10;
    static_cast<void>(matchers.solve(next));
    started_anew = started_anew || matchers.maps() < most;
    most = std::max(most, matchers.maps());
    EXPECT_LE(matchers.bytes(), kCapacity_bytes);
  }
  EXPECT_TRUE(started_anew);
  EXPECT_GT(most, 100U);
  expect_right(matchers, ready_job(room(0, 0.0), room(1, 0.2), 0));
}

TEST_F(SlotMatchersTest, KeepsOneWholeMapOfEachClient) {
  SlotMatchers matchers(std::size_t{64} << 20U);
  const auto answer = [&](const localization::PlaceField& field, const std::string& client) {
    ReadyJob job{place_job(field, 1, client), {}, {}, field.pieces()};
    return matchers.solve(job).solutions;
  };
  const auto one = place_field(2.0);
  const auto other = place_field(3.0);
  EXPECT_EQ(answer(*one, "a"), one->answer(*place_job(*one, 1).task.places));
  const std::size_t bytes = matchers.bytes();
  EXPECT_EQ(answer(*one, "a"), answer(*one, "a"));
  EXPECT_EQ(matchers.bytes(), bytes);
  EXPECT_EQ(answer(*other, "a"), other->answer(*place_job(*other, 1).task.places));
  EXPECT_EQ(matchers.bytes(), bytes + other->bytes() - one->bytes());
  EXPECT_EQ(answer(*one, "b"), answer(*one, "a"));
  EXPECT_EQ(matchers.size(), 2U);
}

}  // namespace
}  // namespace topogeo::search_pool
