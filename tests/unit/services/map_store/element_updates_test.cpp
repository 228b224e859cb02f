// The map on its way: what map_store sends, and what a reader makes of it.
#include "map_store/element_updates.hpp"

#include <gtest/gtest.h>

#include "topogeo/service/map_mirror.hpp"

#include "services/common/random_values.hpp"

namespace topogeo {
namespace {

/// As DDS does it: one handle for each kind and id.
messaging::Handle handle_of(const msg::MapElement& element) {
  messaging::Handle handle;
  handle.bytes[0] = static_cast<std::uint8_t>(element.kind());
  handle.bytes[1] = static_cast<std::uint8_t>(element.id());
  return handle;
}

class Elements : public testing::Test {
 protected:
  map_store::ElementUpdates::Update send(const topomap::GlobalMap& map) {
    auto update = updates_.update_to(map, 1);
    for (const auto& element : update.gone) {
      mirror_.remove(handle_of(element));
      updates_.disposed(element);
    }
    for (const auto& element : update.changed) {
      mirror_.put(element, handle_of(element));
      updates_.sent(element);
    }
    return update;
  }

  support::Random random_{1};
  topomap::GlobalMap map_ = any_global_map(random_);
  map_store::ElementUpdates updates_{"robot"};
  service::MapMirror mirror_;
};

TEST_F(Elements, MirrorHoldsWhatWasSent) {
  EXPECT_FALSE(mirror_.map().has_value());
  const auto update = send(map_);
  EXPECT_EQ(update.changed.size(), 51U);
  EXPECT_EQ(update.changed.back().kind(), msg::kElementSummary);
  ASSERT_TRUE(mirror_.map().has_value());
  EXPECT_TRUE(*mirror_.map() == map_);
}

TEST_F(Elements, OnlyChangesTravel) {
  send(map_);
  EXPECT_TRUE(updates_.update_to(map_, 2).changed.empty());

  map_.version += 1;
  map_.nodes[4].position_m.x() = 1.5;
  map_.branches.pop_back();
  const auto update = send(map_);
  ASSERT_EQ(update.changed.size(), 2U);
  EXPECT_EQ(update.changed[0].id(), map_.nodes[4].id);
  EXPECT_EQ(update.changed[0].map_version(), map_.version);
  EXPECT_EQ(update.changed[1].kind(), msg::kElementSummary);
  EXPECT_EQ(update.changed[1].sequence_number(), 52U);
  ASSERT_EQ(update.gone.size(), 1U);
  EXPECT_EQ(update.gone[0].kind(), msg::kElementBranch);
  ASSERT_TRUE(mirror_.map().has_value());
  EXPECT_TRUE(*mirror_.map() == map_);
}

TEST_F(Elements, WhatCouldNotBeSentComesWithTheNextUpdate) {
  const auto update = updates_.update_to(map_, 1);
  for (std::size_t i = 1; i < update.changed.size(); ++i) updates_.sent(update.changed[i]);
  const auto next = updates_.update_to(map_, 1);
  ASSERT_EQ(next.changed.size(), 1U);
  EXPECT_EQ(next.changed[0].id(), update.changed[0].id());
}

TEST_F(Elements, MapWithAnElementMissingIsNone) {
  const auto update = updates_.update_to(map_, 1);
  for (std::size_t i = update.changed.size(); i-- > 1;) {
    mirror_.put(update.changed[i], handle_of(update.changed[i]));
  }
  EXPECT_FALSE(mirror_.map().has_value());
  mirror_.put(update.changed[0], handle_of(update.changed[0]));
  EXPECT_TRUE(mirror_.map().has_value());
  mirror_.remove(handle_of(update.changed[30]));
  EXPECT_FALSE(mirror_.map().has_value());
}

}  // namespace
}  // namespace topogeo
