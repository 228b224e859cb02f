// The map in transit: messages of map_store, and a reader's map from them.
#include "map_store/element_updates.hpp"

#include <gtest/gtest.h>

#include "topogeo/map_client/map_follower.hpp"
#include "topogeo/service/conversions.hpp"

#include "services/common/random_values.hpp"

namespace topogeo {
namespace {

/// Instance handles like those of DDS: one for each kind and id.
map_client::Handle handle_of(const msg::MapElement& element) {
  return {static_cast<std::uint8_t>(element.kind()), static_cast<std::uint8_t>(element.id())};
}

class Elements : public testing::Test {
 protected:
  map_store::ElementUpdates::Update send(const topomap::GlobalMap& map) {
    auto update = updates_.update_to(map, kMapId, 1);
    for (const auto& element : update.gone) {
      follower_.remove(handle_of(element), kWriter);
      updates_.disposed(element);
    }
    for (auto& element : update.changed) {
      updates_.number(element);
      follower_.put(element, handle_of(element), kWriter);
      updates_.sent(element);
    }
    return update;
  }
  void expect_shown(const topomap::GlobalMap& map) const {
    ASSERT_TRUE(follower_.is_current());
    EXPECT_TRUE(service::from_elements(*follower_.map()) == map);
    EXPECT_EQ(follower_.map()->map_id, kMapId);
  }

  static constexpr std::uint64_t kMapId = 77;
  static constexpr map_client::Handle kWriter{1};
  support::Random random_{1};
  topomap::GlobalMap map_ = any_global_map(random_);
  map_store::ElementUpdates updates_{"robot"};
  map_client::MapFollower follower_{"robot"};
};

TEST_F(Elements, AFollowerHoldsWhatWasSent) {
  EXPECT_EQ(follower_.map(), nullptr);
  const auto update = send(map_);
  EXPECT_EQ(update.changed.size(), 51U);
  EXPECT_EQ(update.changed.back().kind(), msg::kElementSummary);
  expect_shown(map_);
}

TEST_F(Elements, OnlyChangesTravel) {
  send(map_);
  EXPECT_TRUE(updates_.update_to(map_, kMapId, 2).changed.empty());

  map_.version += 1;
  map_.nodes[4].position_m.x() = 1.5;
  map_.branches.pop_back();
  auto update = send(map_);
  ASSERT_EQ(update.changed.size(), 2U);
  EXPECT_EQ(update.changed[0].id(), map_.nodes[4].id);
  EXPECT_EQ(update.changed[0].map_version(), map_.version);
  EXPECT_EQ(update.changed[1].kind(), msg::kElementSummary);
  EXPECT_EQ(update.changed[1].sequence_number(), 52U);
  ASSERT_EQ(update.gone.size(), 1U);
  EXPECT_EQ(update.gone[0].kind(), msg::kElementBranch);
  expect_shown(map_);

  map_.nodes[4].position_m.x() = 2.5;  // with an unchanged version
  update = send(map_);
  ASSERT_EQ(update.changed.size(), 2U);
  expect_shown(map_);
}

TEST_F(Elements, WhatCouldNotBeSentComesWithTheNextUpdate) {
  auto update = updates_.update_to(map_, kMapId, 1);
  for (std::size_t i = 1; i + 1 < update.changed.size(); ++i) updates_.sent(update.changed[i]);
  const auto next = updates_.update_to(map_, kMapId, 1);
  ASSERT_EQ(next.changed.size(), 2U);
  EXPECT_EQ(next.changed[0].id(), update.changed[0].id());
  EXPECT_EQ(next.changed[1].kind(), msg::kElementSummary);
}

}  // namespace
}  // namespace topogeo
