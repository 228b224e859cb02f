#include "topogeo/planning/room_numbers.hpp"

#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

// Three rooms in a row, of 8, 6 and 9 cells of 1 m, with doors of one cell; `moved` columns are
// left free of anything on the left.
FreeSpace row_of_rooms(std::size_t moved = 0, bool second_wall = true) {
  InflationConfig config;
  config.forbidden_cells = 0.0;
  std::vector<std::string> lines(7, std::string(26, '.'));
  lines.front() = lines.back() = std::string(26, '#');
  for (std::size_t row = 1; row < 6; ++row) {
    for (const std::size_t wall : {0U, 9U, 16U, 25U}) lines[row][wall] = '#';
  }
  lines[3][9] = '.';
  lines[3][16] = '.';
  if (!second_wall) {
    for (std::size_t row = 1; row < 6; ++row) lines[row][16] = '.';
  }
  for (std::string& line : lines) line.insert(0, std::string(moved, '?'));
  return FreeSpace(grid_of_text(lines), config);
}

ZoneConfig no_least_size() {
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  return config;
}

std::uint32_t room_at(const FreeSpace& space, const ZoneMap& zones, Cell cell) {
  return zones.zones[zones.zone_of_cell[space.frame().index(cell)]].room;
}

std::string name_at(const FreeSpace& space, const ZoneMap& zones, Cell cell) {
  return zones.zones[zones.zone_of_cell[space.frame().index(cell)]].name;
}

// One stop in the middle of each room.
std::vector<topomap::StopPose> stops_at(double moved_m) {
  std::vector<topomap::StopPose> stops;
  for (const double x_m : {5.0, 13.0, 21.0}) {
    topomap::StopPose& stop = stops.emplace_back();
    stop.stop.number = static_cast<std::uint32_t>(stops.size());
    stop.T_map_robot = {x_m + moved_m, 3.5, 0.0};
  }
  return stops;
}

struct Numbered {
  FreeSpace space;
  ZoneMap zones;
  std::vector<Place> places;
};

Numbered number(RoomNumbers& numbers, FreeSpace space, double moved_m,
                std::vector<Place> places = {}) {
  ZoneMap zones = zones_of_rooms(space, {}, no_least_size());
  numbers.assign(space.frame(), stops_at(moved_m), zones, places);
  return {std::move(space), std::move(zones), std::move(places)};
}

TEST(RoomNumbers, CountFromOneInTheOrderOfTheZones) {
  RoomNumbers numbers;
  const Numbered map = number(numbers, row_of_rooms(), 0.0);
  ASSERT_EQ(map.zones.zones.size(), 3U);
  for (const Zone& zone : map.zones.zones) EXPECT_EQ(zone.room, zone.id + 1U);
}

// The map has moved by more than a room: what lies at the place of a room now is another one.
TEST(RoomNumbers, MoveWithTheMap) {
  RoomNumbers numbers;
  const Numbered before = number(numbers, row_of_rooms(), 0.0);
  const Numbered after = number(numbers, row_of_rooms(9), 9.0);
  for (const int column : {4, 12, 20}) {
    EXPECT_EQ(room_at(after.space, after.zones, {column + 9, 3}),
              room_at(before.space, before.zones, {column, 3}));
  }
}

TEST(RoomNumbers, OfTheLargerStaysWhenTwoAreJoinedAndComesBackToIt) {
  RoomNumbers numbers;
  const Numbered before = number(numbers, row_of_rooms(), 0.0);
  const Numbered joined = number(numbers, row_of_rooms(0, false), 0.0);
  ASSERT_EQ(joined.zones.zones.size(), 2U);
  const std::uint32_t large = room_at(before.space, before.zones, {20, 3});
  EXPECT_EQ(room_at(joined.space, joined.zones, {20, 3}), large);
  EXPECT_EQ(room_at(joined.space, joined.zones, {12, 3}), large);
  const Numbered parted = number(numbers, row_of_rooms(), 0.0);
  EXPECT_EQ(room_at(parted.space, parted.zones, {20, 3}), large);
  EXPECT_EQ(room_at(parted.space, parted.zones, {12, 3}), 4U);  // a new one
}

TEST(RoomNumbers, KeepTheNameOfThePlaceInTheRoom) {
  RoomNumbers numbers;
  const std::vector<Place> places{{"kitchen", {13.5, 2.5}}};
  const Numbered before = number(numbers, row_of_rooms(), 0.0, places);
  EXPECT_EQ(name_at(before.space, before.zones, {12, 3}), "kitchen");
  EXPECT_EQ(name_at(before.space, before.zones, {4, 3}), "room 1");
  EXPECT_EQ(before.places[0].position_m, places[0].position_m);
  // Without being moved it would lie in the first room.
  const Numbered after = number(numbers, row_of_rooms(9), 9.0, places);
  EXPECT_EQ(name_at(after.space, after.zones, {21, 3}), "kitchen");
  EXPECT_EQ(name_at(after.space, after.zones, {13, 3}), "room 1");
  EXPECT_NEAR(after.places[0].position_m.x(), 22.5, 1e-9);
}

TEST(RoomNumbers, OfAFloorWithoutStopsStayWhereTheRoomsAre) {
  RoomNumbers numbers;
  const FreeSpace space = row_of_rooms();
  ZoneMap first = zones_of_rooms(space, {}, no_least_size());
  ZoneMap second = first;
  std::vector<Place> places;
  numbers.assign(space.frame(), {}, first, places);
  std::swap(second.zones[0].name, second.zones[1].name);
  numbers.assign(space.frame(), {}, second, places);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first.zones[i].room, second.zones[i].room);
}

}  // namespace
}  // namespace topogeo::planning
