#include "topogeo/map_client/map_follower.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulated_store.hpp"

namespace topogeo::map_client {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

constexpr Handle kFirst{1};
constexpr Handle kSecond{2};

/// Instance handles like those of DDS: one for each kind and id.
Handle instance_of(const msg::MapElement& element) {
  return {static_cast<std::uint8_t>(element.kind()), static_cast<std::uint8_t>(element.id())};
}

class Following : public testing::Test {
 protected:
  bool put(const msg::MapElement& element, const Handle& writer = kFirst) {
    return follower_.put(element, instance_of(element), writer);
  }
  bool remove(const msg::MapElement& element, const Handle& writer = kFirst) {
    return follower_.remove(instance_of(element), writer);
  }
  /// Two nodes and a branch between them.
  void put_first_map() {
    put(store_.node(1, 0.0));
    put(store_.node(2, 5.0));
    put(store_.branch(1, 1, 2));
    ASSERT_TRUE(put(store_.summary(10)));
  }
  double x_m(std::uint32_t node) const {
    return follower_.map()->nodes.at(node)->node_position().x_m();
  }

  SimulatedStore store_{77};
  MapFollower follower_{"robot"};
};

TEST(SampleHash, IsFnv1aOfKindIdAndNumber) {
  msg::MapElement element;
  element.kind(msg::kElementBranch);
  element.id(0x01020304);
  element.sequence_number(5);
  std::uint64_t expected = 0xcbf29ce484222325ULL;
  for (const unsigned byte : {1, 0, 0, 0, 4, 3, 2, 1, 5, 0, 0, 0, 0, 0, 0, 0}) {
    expected = (expected ^ byte) * 0x100000001b3ULL;
  }
  EXPECT_EQ(sample_hash(element), expected);
}

TEST_F(Following, ThereIsNoMapBeforeAllOfItHasCome) {
  const msg::MapElement node_1 = store_.node(1, 0.0);
  const msg::MapElement node_2 = store_.node(2, 5.0);
  const msg::MapElement summary = store_.summary(10);
  for (const auto& order : {std::vector{node_1, node_2, summary}, {summary, node_2, node_1}}) {
    MapFollower follower("robot");
    EXPECT_FALSE(follower.put(order[0], instance_of(order[0]), kFirst));
    EXPECT_FALSE(follower.put(order[1], instance_of(order[1]), kFirst));
    EXPECT_EQ(follower.map(), nullptr);
    EXPECT_FALSE(follower.is_current());
    EXPECT_TRUE(follower.put(order[2], instance_of(order[2]), kFirst));
    ASSERT_NE(follower.map(), nullptr);
    EXPECT_EQ(follower.map()->version, 10U);
    EXPECT_EQ(follower.map()->map_id, 77U);
    EXPECT_TRUE(follower.is_current());
  }
}

TEST_F(Following, AnEmptyMapIsAMap) {
  EXPECT_TRUE(put(store_.summary(0)));
  EXPECT_THAT(follower_.map()->nodes, IsEmpty());
}

TEST_F(Following, WhileAnUpdateComesTheMapBeforeStands) {
  put_first_map();
  const Element kept = follower_.map()->nodes.at(1);
  EXPECT_FALSE(put(store_.node(1, 1.0)));
  EXPECT_FALSE(remove(store_.dispose(msg::kElementBranch, 1)));
  EXPECT_FALSE(follower_.is_current());
  EXPECT_EQ(x_m(1), 0.0);
  EXPECT_THAT(follower_.map()->branches, SizeIs(1));
  EXPECT_TRUE(put(store_.summary(11)));
  EXPECT_EQ(x_m(1), 1.0);
  EXPECT_THAT(follower_.map()->branches, IsEmpty());
  EXPECT_TRUE(follower_.is_current());
  EXPECT_EQ(kept->node_position().x_m(), 0.0) << "elements that are kept do not change";
}

// The counts of nodes and branches match the summary: only the samples reveal the gap.
TEST_F(Following, AMapWithAnOldSampleIsNotWhole) {
  put_first_map();
  const msg::MapElement lost = store_.node(1, 1.0);
  EXPECT_FALSE(put(store_.summary(11)));
  EXPECT_EQ(follower_.map()->version, 10U);
  EXPECT_TRUE(put(lost));
  EXPECT_EQ(follower_.map()->version, 11U);
}

TEST_F(Following, ALostDisposalIsNoticedAndMendedByReadingAnew) {
  put_first_map();
  store_.dispose(msg::kElementBranch, 1);
  EXPECT_FALSE(put(store_.summary(11)));
  EXPECT_FALSE(follower_.is_current());
  follower_.begin_again();
  EXPECT_FALSE(follower_.is_current());
  EXPECT_EQ(follower_.map()->version, 10U) << "it stands until the rest has come";
  for (const msg::MapElement& element : store_.history()) put(element);
  EXPECT_EQ(follower_.map()->version, 11U);
  EXPECT_THAT(follower_.map()->branches, IsEmpty());
  EXPECT_TRUE(follower_.is_current());
}

TEST_F(Following, AnElementThatWasNeverReadMayBeDisposed) {
  put_first_map();
  const msg::MapElement missed = store_.node(3, 9.0);
  store_.dispose(msg::kElementNode, 3);
  EXPECT_FALSE(remove(missed));
  EXPECT_TRUE(put(store_.summary(11)));
  EXPECT_THAT(follower_.map()->nodes, SizeIs(2));
}

// Elements disappeared without disposals, because the store was dead.
TEST_F(Following, OfAStoreThatStartsAgainNothingOldIsLeft) {
  put_first_map();
  EXPECT_FALSE(put(store_.node(1, 1.0))) << "killed in the middle of an update";
  EXPECT_FALSE(follower_.is_current());
  SimulatedStore again(77);
  EXPECT_FALSE(put(again.node(2, 5.0), kSecond));
  EXPECT_EQ(follower_.map()->version, 10U);
  EXPECT_TRUE(put(again.summary(9), kSecond));
  EXPECT_EQ(follower_.map()->version, 9U) << "the store may go back: its map counts";
  EXPECT_THAT(follower_.map()->nodes, SizeIs(1));
  EXPECT_THAT(follower_.map()->branches, IsEmpty());
  EXPECT_TRUE(follower_.is_current());
  // Late samples of the first store have no effect.
  EXPECT_FALSE(remove(store_.dispose(msg::kElementNode, 2)));
  EXPECT_TRUE(follower_.is_current());
}

TEST_F(Following, AnotherMapReplacesTheOneBefore) {
  put_first_map();
  SimulatedStore other(78);
  put(other.node(1, 3.0), kSecond);
  EXPECT_TRUE(put(other.summary(1), kSecond));
  EXPECT_EQ(follower_.map()->map_id, 78U);
  EXPECT_EQ(x_m(1), 3.0);
}

TEST_F(Following, OtherRobotsAndOtherVersionsAreNoPartOfIt) {
  msg::MapElement element = store_.summary(1);
  element.robot_id("other");
  EXPECT_FALSE(put(element));
  element.robot_id("robot");
  element.schema_version(msg::kSchemaVersion + 1);
  EXPECT_FALSE(put(element));
  EXPECT_EQ(follower_.map(), nullptr);
}

TEST_F(Following, ChangesLeadFromOneMapToTheNextThatIsTaken) {
  EXPECT_THAT(follower_.take_changes(), IsEmpty());
  put_first_map();
  std::vector<Change> changes = follower_.take_changes();
  ASSERT_THAT(changes, SizeIs(3));
  for (const Change& change : changes) EXPECT_TRUE(change.before == nullptr && change.now);
  EXPECT_THAT(follower_.take_changes(), IsEmpty());

  put(store_.node(3, 1.0));
  put(store_.summary(11));
  remove(store_.dispose(msg::kElementNode, 3));  // added and removed between two calls: no change
  remove(store_.dispose(msg::kElementBranch, 1));
  put(store_.node(1, 0.5));
  put(store_.node(2, 5.0));  // sent again unchanged: no change
  put(store_.summary(12));
  changes = follower_.take_changes();
  ASSERT_THAT(changes, SizeIs(2));
  EXPECT_EQ(changes[0].before->node_position().x_m(), 0.0);
  EXPECT_EQ(changes[0].now->node_position().x_m(), 0.5);
  EXPECT_EQ(changes[1].before->kind(), msg::kElementBranch);
  EXPECT_EQ(changes[1].now, nullptr);
}

}  // namespace
}  // namespace topogeo::map_client
