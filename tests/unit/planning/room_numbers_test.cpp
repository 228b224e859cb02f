#include "topogeo/planning/room_numbers.hpp"

#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

// Three rooms in a row, of 8, 6 and 9 cells of 1 m, with doors of one cell, shifted to the right by
// `moved` empty columns.
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
  numbers.assign(space, stops_at(moved_m), zones, places);
  return {std::move(space), std::move(zones), std::move(places)};
}

TEST(RoomNumbers, CountFromOneInTheOrderOfTheZones) {
  RoomNumbers numbers;
  const Numbered map = number(numbers, row_of_rooms(), 0.0);
  ASSERT_EQ(map.zones.zones.size(), 3U);
  for (const Zone& zone : map.zones.zones) EXPECT_EQ(zone.room, zone.id + 1U);
}

// The map has moved by more than a room, so a room's old place is now in another room.
TEST(RoomNumbers, MoveWithTheMap) {
  RoomNumbers numbers;
  const Numbered before = number(numbers, row_of_rooms(), 0.0);
  const Numbered after = number(numbers, row_of_rooms(9), 9.0);
  for (const int column : {4, 12, 20}) {
    EXPECT_EQ(room_at(after.space, after.zones, {column + 9, 3}),
              room_at(before.space, before.zones, {column, 3}));
  }
}

TEST(RoomNumbers, OfTheLargerStaysWhenTwoAreJoinedAndBothComeBack) {
  RoomNumbers numbers;
  const Numbered before = number(numbers, row_of_rooms(), 0.0);
  const Numbered joined = number(numbers, row_of_rooms(0, false), 0.0);
  ASSERT_EQ(joined.zones.zones.size(), 2U);
  const std::uint32_t large = room_at(before.space, before.zones, {20, 3});
  EXPECT_EQ(room_at(joined.space, joined.zones, {20, 3}), large);
  EXPECT_EQ(room_at(joined.space, joined.zones, {12, 3}), large);
  const Numbered parted = number(numbers, row_of_rooms(), 0.0);
  EXPECT_EQ(room_at(parted.space, parted.zones, {20, 3}), large);
  EXPECT_EQ(room_at(parted.space, parted.zones, {12, 3}),
            room_at(before.space, before.zones, {12, 3}));
}

TEST(RoomNumbers, KeepTheNameOfThePlaceInTheRoom) {
  RoomNumbers numbers;
  const std::vector<Place> places{{"kitchen", {13.5, 2.5}}};
  const Numbered before = number(numbers, row_of_rooms(), 0.0, places);
  EXPECT_EQ(name_at(before.space, before.zones, {12, 3}), "kitchen");
  EXPECT_EQ(name_at(before.space, before.zones, {4, 3}), "room 1");
  EXPECT_EQ(before.places[0].position_m, places[0].position_m);
  // Without the shift it would be in the first room.
  const Numbered after = number(numbers, row_of_rooms(9), 9.0, places);
  EXPECT_EQ(name_at(after.space, after.zones, {21, 3}), "kitchen");
  EXPECT_EQ(name_at(after.space, after.zones, {13, 3}), "room 1");
  EXPECT_NEAR(after.places[0].position_m.x(), 22.5, 1e-9);
}

// Like a restart: the second object starts from the first one's memory, and the map has moved.
TEST(RoomNumbers, GoOnFromWhatAnotherOneRemembered) {
  RoomNumbers before;
  const std::vector<Place> places{{"kitchen", {13.5, 2.5}, 0.5}};
  const Numbered first = number(before, row_of_rooms(0, false), 0.0, places);
  ASSERT_EQ(first.zones.zones.size(), 2U);
  static_cast<void>(number(before, row_of_rooms(), 0.0, places));
  RoomNumbers after(before.memory());
  EXPECT_EQ(after.memory(), before.memory());
  const Numbered moved = number(after, row_of_rooms(9), 9.0, places);
  EXPECT_EQ(room_at(moved.space, moved.zones, {29, 3}), 2U);
  EXPECT_EQ(room_at(moved.space, moved.zones, {21, 3}), 3U);
  EXPECT_EQ(name_at(moved.space, moved.zones, {29, 3}), "kitchen");
  RoomNumbers anew;
  const Numbered other = number(anew, row_of_rooms(9), 9.0);
  EXPECT_NE(room_at(other.space, other.zones, {21, 3}), 3U) << "else this shows nothing";
}

// The map has rotated by a quarter turn around its origin, and a base station's heading with it.
TEST(RoomNumbers, TurnTheBaseStationWithItsRoom) {
  const auto on_its_side = [](const FreeSpace& space) {
    const GridFrame& frame = space.frame();
    GridFrame turned;
    turned.columns = frame.rows;
    turned.rows = frame.columns;
    turned.resolution_m = frame.resolution_m;
    turned.T_map_grid = {-static_cast<double>(frame.rows) * frame.resolution_m, 0.0, 0.0};
    OccupancyGrid grid(turned);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      grid.set({frame.rows - 1 - cell.row, cell.column}, space.grid().at(cell));
    }
    InflationConfig config;
    config.forbidden_cells = 0.0;
    return FreeSpace(std::move(grid), config);
  };
  RoomNumbers numbers;
  const std::vector<Place> places{{"base station", {13.5, 2.5}, 1.0}};
  const Numbered before = number(numbers, row_of_rooms(), 0.0, places);
  EXPECT_EQ(before.places[0], places[0]);
  FreeSpace space = on_its_side(row_of_rooms());
  std::vector<topomap::StopPose> stops = stops_at(0.0);
  for (topomap::StopPose& stop : stops)
    stop.T_map_robot = geometry::Pose2{0.0, 0.0, M_PI_2} * stop.T_map_robot;
  ZoneMap zones = zones_of_rooms(space, {}, no_least_size());
  std::vector<Place> after = places;
  numbers.assign(space, stops, zones, after);
  EXPECT_NEAR((after[0].position_m - Eigen::Vector2d(-2.5, 13.5)).norm(), 0.0, 1e-9);
  ASSERT_TRUE(after[0].station_heading_rad);
  EXPECT_NEAR(*after[0].station_heading_rad, 1.0 + M_PI_2, 1e-9);
}

// A place that is moved by hand stays where it was put.
TEST(RoomNumbers, LeaveAPlaceThatWasDrawnAnew) {
  RoomNumbers numbers;
  static_cast<void>(number(numbers, row_of_rooms(), 0.0, {{"kitchen", {13.5, 2.5}}}));
  const Numbered after = number(numbers, row_of_rooms(), 0.0, {{"kitchen", {4.5, 2.5}}});
  EXPECT_EQ(after.places[0].position_m, Eigen::Vector2d(4.5, 2.5));
}

TEST(RoomNumbers, OfAFloorWithoutStopsStayWhereTheRoomsAre) {
  RoomNumbers numbers;
  const FreeSpace space = row_of_rooms();
  ZoneMap first = zones_of_rooms(space, {}, no_least_size());
  ZoneMap second = first;
  std::vector<Place> places;
  numbers.assign(space, {}, first, places);
  std::swap(second.zones[0].name, second.zones[1].name);
  numbers.assign(space, {}, second, places);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first.zones[i].room, second.zones[i].room);
}

}  // namespace
}  // namespace topogeo::planning
