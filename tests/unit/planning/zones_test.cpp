#include "topogeo/planning/zones.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/drawn_and_found_rooms.hpp"

#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Two rooms of 8 x 9 and 9 x 9 cells and a door of three cells between them.
FreeSpace two_rooms() {
  InflationConfig config;
  config.forbidden_cells = 0.0;
  std::vector<std::string> lines(9, "........#.........");
  for (std::size_t i = 3; i < 6; ++i) lines[i][8] = '.';
  return FreeSpace(grid_of_text(lines), config);
}

ZoneConfig small_zones() {
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  config.passage_half_width_m = 2.1;
  return config;
}

ZoneId zone_at(const FreeSpace& space, const ZoneMap& map, Cell cell) {
  return map.zone_of_cell[space.frame().index(cell)];
}

// Invariants of all zones, however they are made.
void expect_sound(const FreeSpace& space, const ZoneMap& map) {
  const GridFrame& frame = space.frame();
  std::vector<std::size_t> cells(map.zones.size(), 0);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    ASSERT_EQ(map.zone_of_cell[i] != kNoZone, space.passable(i));
    if (!space.passable(i)) continue;
    ASSERT_LT(map.zone_of_cell[i], map.zones.size());
    ++cells[map.zone_of_cell[i]];
    EXPECT_TRUE(map.zones[map.zone_of_cell[i]].box.contains(frame.cell_at(i)));
  }
  for (const Zone& zone : map.zones) {
    EXPECT_EQ(zone.cells, cells[zone.id]);
    // A search from its first cell reaches all of them.
    const SearchWindow window(frame, zone.box, map.zone_of_cell, zone.id);
    std::vector<Cell> all;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (map.zone_of_cell[i] == zone.id) all.push_back(frame.cell_at(i));
    }
    for (const auto& path : shortest_paths(window, all.front(), all)) ASSERT_TRUE(path);
  }
}

TEST(Zones, AreCutApartAtAPassage) {
  const FreeSpace space = two_rooms();
  const std::vector<Passage> door{{{8.5, 4.5}, Eigen::Vector2d::UnitX(), 1.5}};
  const ZoneMap map = zones_of_rooms(space, door, small_zones());
  ASSERT_EQ(map.zones.size(), 2U);
  EXPECT_NE(zone_at(space, map, {7, 4}), zone_at(space, map, {9, 4}));
  EXPECT_EQ(zone_at(space, map, {0, 0}), zone_at(space, map, {7, 8}));
  expect_sound(space, map);
}

TEST(Zones, AreNotCutWhereAPassageMeetsNoWalls) {
  const FreeSpace space = two_rooms();
  const std::vector<Passage> middle{{{4.5, 4.5}, Eigen::Vector2d::UnitX(), 1.5}};
  EXPECT_EQ(zones_of_rooms(space, middle, small_zones()).zone_of_cell,
            zones_of_rooms(space, {}, small_zones()).zone_of_cell);
}

// Two rooms of 9 x 9 cells of 0.25 m; the passage between them is 5 wide, 0.6 of their width.
TEST(Zones, MeetAtAWideDoorWhereTheMapHasOne) {
  InflationConfig config;
  config.forbidden_cells = 0.0;
  std::vector<std::string> lines(11, "#.........#.........#");
  lines.front() = lines.back() = std::string(21, '#');
  for (std::size_t i = 3; i < 8; ++i) lines[i][10] = '.';
  const FreeSpace space(grid_of_text(lines, 0.25), config);
  EXPECT_EQ(zones_of_rooms(space, {}, small_zones()).zones.size(), 1U);
  const std::vector<Passage> door{{{2.625, 1.375}, Eigen::Vector2d::UnitX(), 0.75}};
  const ZoneMap map = zones_of_rooms(space, door, small_zones());
  ASSERT_EQ(map.zones.size(), 2U);
  EXPECT_NE(zone_at(space, map, {8, 5}), zone_at(space, map, {12, 5}));
  expect_sound(space, map);
}

// A floor of 30 cells, and a separate pocket of 5 behind a wall.
TEST(Zones, PocketsThatNothingLeadsToAreNoFloor) {
  InflationConfig config;
  config.forbidden_cells = 0.0;
  const std::vector<std::string> lines{"..........#..", "..........#..", "..........##."};
  EXPECT_TRUE(FreeSpace(grid_of_text(lines), config).passable({11, 1}));
  config.min_pocket_m2 = 5.0;
  EXPECT_TRUE(FreeSpace(grid_of_text(lines), config).passable({11, 1}));
  config.min_pocket_m2 = 5.5;
  const FreeSpace space(grid_of_text(lines), config);
  EXPECT_FALSE(space.passable({11, 1}));
  EXPECT_FALSE(space.passable({12, 0}));
  EXPECT_TRUE(space.passable({3, 1}));
}

TEST(Zones, AreFoundByTheWidthOfTheFloor) {
  const FreeSpace space = two_rooms();
  const ZoneMap map = zones_by_width(space, small_zones());
  ASSERT_EQ(map.zones.size(), 2U);
  EXPECT_NE(zone_at(space, map, {6, 4}), zone_at(space, map, {10, 4}));
  expect_sound(space, map);
}

TEST(Zones, SmallOnesJoinTheNeighbourWithTheLongestBorder) {
  const FreeSpace space = two_rooms();
  ZoneConfig config = small_zones();
  // The left room has 72 m2 and the door 3, the right room has 81.
  config.min_area_m2 = 75.0;
  EXPECT_EQ(zones_by_width(space, config).zones.size(), 2U);
  config.min_area_m2 = 80.0;
  const ZoneMap map = zones_by_width(space, config);
  ASSERT_EQ(map.zones.size(), 1U);
  EXPECT_EQ(map.zones[0].cells, 156U);
}

TEST(Zones, ThatAreDrawnKeepTheirNamesAndSizes) {
  const FreeSpace space = two_rooms();
  ZoneConfig config = small_zones();
  config.min_area_m2 = 100.0;
  const std::vector<DrawnZone> drawn{{"west", {{0.0, 0.0}, {8.5, 0.0}, {8.5, 9.0}, {0.0, 9.0}}},
                                     {"both", {{4.0, 0.0}, {18.0, 0.0}, {18.0, 4.0}, {4.0, 4.0}}}};
  const ZoneMap map = drawn_zones(space, drawn, config);
  ASSERT_EQ(map.zones.size(), 2U);
  EXPECT_EQ(map.zones[zone_at(space, map, {5, 2})].name, "west");
  EXPECT_EQ(map.zones[zone_at(space, map, {12, 2})].name, "both");
  // The area left undrawn is too small to be a separate zone.
  EXPECT_EQ(map.zones[zone_at(space, map, {12, 8})].name, "both");
  expect_sound(space, map);
}

TEST(Zones, PartsOfADrawnOneThatWallsSeparateAreZonesOfTheirOwn) {
  const FreeSpace space = two_rooms();
  const std::vector<DrawnZone> drawn{{"south", {{0.0, 0.0}, {18.0, 0.0}, {18.0, 2.0}, {0.0, 2.0}}}};
  const ZoneMap map = drawn_zones(space, drawn, small_zones());
  ASSERT_EQ(map.zones.size(), 3U);
  EXPECT_EQ(map.zones[zone_at(space, map, {12, 0})].name, "south");
  EXPECT_EQ(map.zones[zone_at(space, map, {2, 0})].name, "south 2");
  expect_sound(space, map);
}

TEST(Zones, ThatAreDrawnLeaveTheRoomsBesideThemAsTheyWereFound) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const BlockFloor floor = block_floor({}, seed);
    const FreeSpace space(floor.grid);
    const ZoneMap found = zones_of_rooms(space);
    const std::vector<DrawnZone> one{floor.rooms.front()};
    const ZoneMap map = zones_of_drawn_and_found_rooms(space, one);
    expect_sound(space, map);
    const auto same_name = [&](const Zone& zone) { return zone.name == one.front().name; };
    const auto drawn = std::find_if(map.zones.begin(), map.zones.end(), same_name);
    ASSERT_NE(drawn, map.zones.end());
    // The undrawn cells of each detected zone still form one zone.
    std::vector<std::vector<std::size_t>> cells(found.zones.size(),
                                                std::vector<std::size_t>(map.zones.size()));
    for (std::size_t i = 0; i < found.zone_of_cell.size(); ++i) {
      if (space.passable(i)) ++cells[found.zone_of_cell[i]][map.zone_of_cell[i]];
    }
    std::set<std::size_t> largest;
    std::size_t taken = 0;
    for (const std::vector<std::size_t>& into : cells) {
      const auto most = std::max_element(into.begin(), into.end()) - into.begin();
      if (static_cast<ZoneId>(most) == drawn->id) {
        ++taken;
      } else {
        EXPECT_TRUE(largest.insert(static_cast<std::size_t>(most)).second) << "seed " << seed;
      }
    }
    EXPECT_LE(taken, 1U);
    EXPECT_GT(largest.size(), 3U);
    EXPECT_EQ(zones_of_drawn_and_found_rooms(space, {}).zone_of_cell, found.zone_of_cell);
  }
}

TEST(Zones, HangTogetherOnRandomFloors) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const BlockFloor floor = block_floor({}, seed);
    const FreeSpace space(floor.grid);
    expect_sound(space, zones_by_width(space));
    expect_sound(space, zones_of_rooms(space));
    expect_sound(space, drawn_zones(space, floor.rooms));
  }
}

TEST(Zones, RefuseAConfigurationOutOfRange) {
  ZoneConfig config;
  config.min_area_m2 = -1.0;
  EXPECT_THAT([&] { check(config); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(
                  "key 'hybrid_map.min_zone_m2' = '-1': expected number between 0 and 1000 m2")));
}

// A corridor along x through a door at (5, 0), and a branch that ends at a narrowing.
TEST(Passages, AreTheDoorsAndNarrowingsOfAMap) {
  topomap::GlobalMap map;
  using topomap::NodeKind;
  map.nodes = {{1, NodeKind::kReal, {0, 0}, 1.0, 1},
               {2, NodeKind::kDoor, {5, 0}, 0.45, 1},
               {3, NodeKind::kNarrowing, {5, 5}, 0.8, 1},
               {4, NodeKind::kDoor, {9, 9}, 0.45, 1}};
  map.branches.resize(2);
  map.branches[0].node_a = 1;
  map.branches[0].node_b = 2;
  map.branches[0].points = {{{0, 0}, 1.0}, {{4, 0}, 0.5}, {{4.9, 0.1}, 0.46}, {{5, 0}, 0.45}};
  map.branches[1].node_a = 2;
  map.branches[1].node_b = 3;
  map.branches[1].points = {{{5, 0}, 0.45}, {{6, 0}, 0.8}, {{5, 4}, 0.9}, {{5, 5}, 0.8}};
  const std::vector<Passage> passages = passages_of(map);
  ASSERT_EQ(passages.size(), 2U);
  EXPECT_EQ(passages[0].position_m, Eigen::Vector2d(5, 0));
  EXPECT_DOUBLE_EQ(std::abs(passages[0].along.x()), 1.0);
  EXPECT_DOUBLE_EQ(std::abs(passages[1].along.y()), 1.0);
  EXPECT_DOUBLE_EQ(passages[1].clearance_m, 0.8);
}

TEST(ZoneDrawing, ReadsZonesAndPlaces) {
  const ZoneDrawing drawing = parse_zone_drawing(
      "zones:\n"
      "  - {name: hall, polygon: [[0, 0], [4, 0], [4, 3]]}\n"
      "places:\n"
      "  - {name: room A, at: [1.5, 2.0]}\n"
      "  - {name: dock, at: [0.5, 1], heading: 1.5}\n",
      "floor");
  ASSERT_EQ(drawing.zones.size(), 1U);
  EXPECT_EQ(drawing.zones[0].name, "hall");
  EXPECT_EQ(drawing.zones[0].polygon_m[2], Eigen::Vector2d(4, 3));
  const Place room{"room A", {1.5, 2.0}};
  const Place dock{"dock", {0.5, 1.0}, 1.5};
  EXPECT_EQ(drawing.places, (std::vector<Place>{room, dock}));
}

TEST(ZoneDrawing, ReadsWhatAZoneIsFor) {
  const ZoneDrawing drawing = parse_zone_drawing(
      "zones:\n"
      "  - {name: a, polygon: [[0, 0], [4, 0], [4, 3]]}\n"
      "  - {name: b, kind: no_go, polygon: [[0, 0], [4, 0], [4, 3]]}\n"
      "  - {name: c, kind: slow, value: 0.3, polygon: [[0, 0], [4, 0], [4, 3]]}\n"
      "  - {name: d, kind: one_way, value: -1.5, polygon: [[0, 0], [4, 0], [4, 3]]}\n",
      "floor");
  ASSERT_EQ(drawing.zones.size(), 4U);
  EXPECT_EQ(drawing.zones[0].kind, ZoneKind::kRoom);
  EXPECT_EQ(drawing.zones[1].kind, ZoneKind::kNoGo);
  EXPECT_EQ(drawing.zones[2].kind, ZoneKind::kSlow);
  EXPECT_EQ(drawing.zones[2].value, 0.3);
  EXPECT_EQ(drawing.zones[3].kind, ZoneKind::kOneWay);
  EXPECT_EQ(drawing.zones[3].value, -1.5);
}

TEST(ZoneDrawing, NamesTheLineOfWhatIsWrong) {
  const auto expect = [](const std::string& text, const std::string& where,
                         const std::string& what) {
    EXPECT_THAT([&] { parse_zone_drawing(text, "f.yaml"); },
                ThrowsMessage<std::runtime_error>(AllOf(HasSubstr(where), HasSubstr(what))))
        << text;
  };
  expect("- 1", "f.yaml:1", "a map with the keys zones, places, walls, openings and doors");
  expect("places:\n  - {name: a, at: [1]}", "f.yaml:2: at", "[x, y]");
  expect("places:\n  - {name: a, at: [1, .inf]}", "f.yaml:2: at", "a number from");
  expect("places:\n  - {name: '', at: [1, 2]}", "f.yaml:2: name", "a non-empty text");
  expect("places:\n  - {at: [1, 2]}", "name", "a text");
  expect("places:\n  - {name: a, at: [1, 2], heading: 4}", "f.yaml:2: heading", "a number from");
  expect("places:\n  - {name: a, at: [1, 2]}\n  - {name: a, at: [1, 2]}", "f.yaml:3: name",
         "each name once");
  expect("zones:\n  - {name: a, polygon: [[1, 2], [3, 4]]}", "f.yaml:2: polygon", "three corners");
  expect("zones:\n  - {name: a, color: red}", "f.yaml:2: a zone", "'color'");
  const std::string corners = "polygon: [[0, 0], [4, 0], [4, 3]]}";
  expect("zones:\n  - {name: a, kind: lava, " + corners, "f.yaml:2: kind", "one_way");
  expect("zones:\n  - {name: a, kind: slow, " + corners, "value", "m/s");
  expect("zones:\n  - {name: a, kind: slow, value: 0, " + corners, "f.yaml:2: value", "0.01");
  expect("zones:\n  - {name: a, kind: no_go, value: 1, " + corners, "f.yaml:2: value", "no value");
  expect("zones: 3", "f.yaml:1: zones", "a list");
  expect("zones: [", "f.yaml:1", "");
}

TEST(ZoneDrawing, NamesALineFromOneOnForWhatIsNoYaml) {
  for (const std::string text : {"[", "a: *b", "%YAML 5\n---\na", "!<", "a\nb:", "\"\\q\""}) {
    EXPECT_THAT([&] { parse_zone_drawing(text, "f.yaml"); },
                ThrowsMessage<std::runtime_error>(testing::MatchesRegex("f.yaml:[1-9].*")))
        << text;
  }
  const std::string deep(6000, '[');
  EXPECT_THAT([&] { parse_zone_drawing(deep, "f.yaml"); },
              ThrowsMessage<std::runtime_error>(HasSubstr("f.yaml:1: ")));
}

}  // namespace
}  // namespace topogeo::planning
