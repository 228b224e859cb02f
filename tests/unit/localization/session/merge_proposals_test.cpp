#include "topogeo/session/merge_proposals.hpp"

#include <map>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::localization {
namespace {

using State = MergeProposal::State;

/// Stops of session s are in map s, stop n at x = n metres.
struct MergeProposalsTest : ::testing::Test {
  MergeProposals::Find find = [this](const topomap::StopId& stop) {
    const auto map = maps.find(stop.session);
    if (map == maps.end() || stop.number > newest) return std::optional<MergeProposals::Placed>();
    return std::optional<MergeProposals::Placed>(
        {map->second, {static_cast<double>(stop.number), 0.0, 0.0}});
  };
  static MergeProposal at(topomap::StopId stop, topomap::StopId other) {
    MergeProposal found;
    found.place.stop = stop;
    found.place.other = other;
    return found;
  }

  std::map<std::uint64_t, std::uint32_t> maps{{1, 1}, {2, 2}, {3, 3}};
  std::uint32_t newest = 1000;  // stop of each session
  MergeProposals proposals;
};

TEST_F(MergeProposalsTest, OneOfTwoMapsIsOpenWhoeverWasFollowed) {
  EXPECT_TRUE(proposals.offer(at({1, 5}, {2, 50}), find));
  EXPECT_TRUE(proposals.offer(at({2, 52}, {1, 7}), find));
  EXPECT_TRUE(proposals.offer(at({3, 5}, {2, 50}), find));
  ASSERT_EQ(proposals.all().size(), 2U);
  EXPECT_EQ(proposals.all()[0].number, 1U);
  EXPECT_EQ(proposals.all()[0].place.stop, (topomap::StopId{2, 52}));
  EXPECT_EQ(proposals.all()[1].number, 2U);
}

TEST_F(MergeProposalsTest, ARefusedOneComesAgainForAnotherPlaceAndThenTwiceAsFar) {
  proposals.offer(at({1, 5}, {2, 50}), find);
  EXPECT_EQ(proposals.refuse(1).state, State::kRefused);
  EXPECT_FALSE(proposals.offer(at({1, 14}, {2, 59}), find));
  EXPECT_FALSE(proposals.offer(at({2, 59}, {1, 14}), find));
  EXPECT_TRUE(proposals.offer(at({3, 5}, {2, 50}), find)) << "another map";
  EXPECT_TRUE(proposals.offer(at({2, 50}, {1, 15}), find)) << "a place of one that looks alike";
  proposals.refuse(3);
  EXPECT_FALSE(proposals.offer(at({1, 34}, {2, 69}), find));
  EXPECT_TRUE(proposals.offer(at({1, 35}, {2, 70}), find));
}

TEST_F(MergeProposalsTest, WhatWasRefusedBeforeIsHeededAndNotShown) {
  proposals.remember_refused({1, 5}, {2, 50});
  EXPECT_FALSE(proposals.offer(at({2, 59}, {1, 14}), find));
  EXPECT_TRUE(proposals.all().empty());
  EXPECT_TRUE(proposals.offer(at({2, 50}, {1, 15}), find));
  EXPECT_EQ(proposals.refuse(1).number, 1U);
  EXPECT_FALSE(proposals.offer(at({1, 34}, {2, 69}), find)) << "twice as far";
  EXPECT_TRUE(proposals.offer(at({1, 35}, {2, 70}), find));
}

TEST_F(MergeProposalsTest, ARefusalOfAStopThatIsStillToComeAgainIsHeeded) {
  proposals.remember_refused({1, 19}, {2, 6});
  newest = 18;
  EXPECT_FALSE(proposals.offer(at({1, 18}, {2, 5}), find));
  EXPECT_TRUE(proposals.offer(at({1, 8}, {2, 17}), find)) << "other places";
}

TEST_F(MergeProposalsTest, OnlyOpenOnesAreAnswered) {
  EXPECT_THROW(proposals.accept(1), std::invalid_argument);
  proposals.offer(at({1, 5}, {2, 50}), find);
  proposals.offer(at({1, 5}, {3, 50}), find);
  EXPECT_EQ(proposals.accept(1).place.other, (topomap::StopId{2, 50}));
  EXPECT_THROW(proposals.refuse(1), std::invalid_argument);
  maps.erase(3);
  proposals.check(find);
  EXPECT_EQ(proposals.all()[1].state, State::kWithdrawn);
  EXPECT_THROW(proposals.accept(2), std::invalid_argument);
}

TEST_F(MergeProposalsTest, MapsThatHaveBecomeOneByAnotherNeedNoAnswer) {
  proposals.offer(at({1, 5}, {2, 50}), find);
  maps[2] = 1;
  proposals.check(find);
  EXPECT_EQ(proposals.all()[0].state, State::kAccepted);
}

}  // namespace
}  // namespace topogeo::localization
