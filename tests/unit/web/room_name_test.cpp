#include <gtest/gtest.h>

#include "topogeo/msg/hybrid_map.h"

#include "channels/map_view.hpp"

namespace topogeo::web {
namespace {

TEST(RoomName, OfARoomNamedAfterItsPlaceIsThatOfItsNumber) {
  msg::HybridMap map;
  msg::HybridPlace place;
  place.name("kitchen");
  map.places().push_back(place);
  msg::HybridZone room;
  room.room(12);
  room.name("kitchen");
  EXPECT_EQ(room_name(room, map), "room 12");
  room.name("room 12");
  EXPECT_EQ(room_name(room, map), "room 12");
  room.name("hall");
  EXPECT_EQ(room_name(room, map), "hall");
  room.room(0);
  room.name("kitchen");
  EXPECT_EQ(room_name(room, map), "kitchen") << "a drawn room has no number";
}

}  // namespace
}  // namespace topogeo::web
