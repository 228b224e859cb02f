#include "topogeo/world/world.hpp"

#include <filesystem>

#include <gmock/gmock.h>

namespace topogeo::world {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(World, ADoorIsAGapInItsWall) {
  const World world = parse_world(
      "walls:\n  - {from: [0, 0], to: [10, 0], doors: [{at: 7, width: 1}, {at: 2, width: 2}]}\n",
      "w");
  ASSERT_EQ(world.segments.size(), 3U);
  EXPECT_EQ(world.segments[0].b_m, Eigen::Vector2d(1.0, 0.0));
  EXPECT_EQ(world.segments[1].a_m, Eigen::Vector2d(3.0, 0.0));
  EXPECT_EQ(world.segments[1].b_m, Eigen::Vector2d(6.5, 0.0));
  EXPECT_EQ(world.segments[2].a_m, Eigen::Vector2d(7.5, 0.0));
}

TEST(World, AThickWallHasTwoSidesAndTwoEnds) {
  const World world = parse_world("wall_thickness: 0.2\nwalls: [{from: [0, 0], to: [4, 0]}]", "w");
  EXPECT_EQ(world.segments.size(), 4U);
  EXPECT_NEAR(clearance_m(world, {2.0, 1.0}), 0.9, 1e-12);
  EXPECT_NEAR(clearance_m(world, {2.0, -1.0}), 0.9, 1e-12);
  EXPECT_NEAR(clearance_m(world, {5.0, 0.0}), 1.0, 1e-12);
}

TEST(World, ClearanceIsTheDistanceToTheNearestSurface) {
  const World world = parse_world(
      "name: n\nsegments: [[0, 0, 4, 0]]\ncolumns: [{center: [2, 5], radius: 1}]\n"
      "boxes: [{from: [10, 0], to: [11, 2]}]\ntour: [[1, 1], [2, 2]]\n",
      "w");
  EXPECT_EQ(world.name, "n");
  EXPECT_EQ(world.tour_m.size(), 2U);
  EXPECT_NEAR(clearance_m(world, {1.0, 1.0}), 1.0, 1e-12);
  EXPECT_NEAR(clearance_m(world, {2.0, 3.0}), 1.0, 1e-12);
  EXPECT_NEAR(clearance_m(world, {-3.0, -4.0}), 5.0, 1e-12);
  EXPECT_NEAR(clearance_m(world, {9.0, 1.0}), 1.0, 1e-12);
}

struct BadWorld {
  const char* name;
  const char* text;
  const char* message;
};

// Printed by the test runner instead of the bytes.
std::ostream& operator<<(std::ostream& out, const BadWorld& tested) {
  return out << tested.name;
}

class BadWorlds : public ::testing::TestWithParam<BadWorld> {};

TEST_P(BadWorlds, AreErrorsThatNameFileAndLine) {
  try {
    parse_world(GetParam().text, "bad.yaml");
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("bad.yaml:"), HasSubstr(GetParam().message)));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(
    World, BadWorlds,
    ::testing::Values(
        BadWorld{"empty", "", ":1: the world: expected a map"},
        BadWorld{"scalar", "hello", "expected a map"},
        BadWorld{"no_yaml", "walls: [\n  {from", "bad.yaml:"},
        BadWorld{"no_surface", "name: x\n", "expected walls, boxes"},
        BadWorld{"unknown_key", "name: x\nwals: []\n", ":2: the world: expected one of the keys"},
        BadWorld{"walls_scalar", "walls: 3\n", ":1: walls: expected a list, got '3'"},
        BadWorld{"missing_to", "walls:\n  - {from: [0, 0]}\n", ":2: to: expected a value"},
        BadWorld{"one_number", "walls:\n  - from: [0]\n    to: [1, 1]\n", ":2: from: expected 2"},
        BadWorld{"not_a_number", "segments:\n  - [0, 0, 1, x]\n",
                 ":2: segments: expected a number"},
        BadWorld{"nan", "segments:\n  - [0, 0, 1, .nan]\n", ":2: segments: expected a number"},
        BadWorld{"far", "segments:\n  - [0, 0, 1, 1e9]\n", "got '1e9'"},
        BadWorld{"no_length", "segments:\n\n  - [1, 1, 1, 1]\n", ":3: segments: expected two diff"},
        BadWorld{"radius", "columns:\n  - {center: [0, 0], radius: -1}\n", ":2: radius: expected"},
        BadWorld{"flat_box", "boxes: [{from: [0, 0], to: [0, 1]}]", "a box without area"},
        BadWorld{"thickness", "wall_thickness: 7\nwalls: []\n", ":1: wall_thickness: expected"},
        BadWorld{"door_outside",
                 "walls:\n  - {from: [0, 0], to: [4, 0], doors: [{at: 3.9, width: 0.9}]}\n",
                 ":2: doors: expected a door inside its wall"},
        BadWorld{"doors_overlap",
                 "walls:\n  - from: [0, 0]\n    to: [4, 0]\n    doors:\n"
                 "      - {at: 2, width: 0.9}\n      - {at: 2.5, width: 0.9}\n",
                 ":6: doors: expected"},
        BadWorld{
            "open_order",
            "walls:\n  - {from: [0, 0], to: [4, 0],\n     doors: [{at: 2, width: 1, open: [[5, "
            "2]]}]}\n",
            ":3: open: expected [from, to] with from < to"},
        BadWorld{"present_one", "boxes:\n  - {from: [0, 0], to: [1, 1], present: [[5]]}\n",
                 ":2: present: expected intervals of the distance"},
        BadWorld{"present_negative",
                 "columns:\n  - {center: [0, 0], radius: 1, present: [[-1, 2]]}\n",
                 ":2: present: expected a number from 0 to"},
        BadWorld{"person_without_path", "segments: [[0, 0, 1, 1]]\npeople:\n  - {speed: 1}\n",
                 ":3: path: expected a value"},
        BadWorld{"person_nowhere", "segments: [[0, 0, 1, 1]]\npeople:\n  - {path: []}\n",
                 ":3: path: expected a point or more"},
        BadWorld{"person_flies",
                 "segments: [[0, 0, 1, 1]]\npeople:\n  - {path: [[0, 0]], speed: 99}\n",
                 ":3: speed: expected a number from 0 to 10 m/s"},
        BadWorld{"person_wings",
                 "segments: [[0, 0, 1, 1]]\npeople:\n  - {path: [[0, 0]], wings: 2}\n",
                 ":3: people: expected one of the keys"},
        BadWorld{"place_without_name", "segments: [[0, 0, 1, 1]]\nplaces:\n  - {at: [1, 2]}\n",
                 ":3: name: expected a value, got nothing"},
        BadWorld{"place_with_a_taken_name",
                 "segments: [[0, 0, 1, 1]]\nplaces:\n  - {name: a, at: [1, 2]}\n"
                 "  - {name: a, at: [1, 3]}\n",
                 ":4: name: expected a non-empty name that is not taken, got 'a'"},
        BadWorld{"place_nowhere", "segments: [[0, 0, 1, 1]]\nplaces:\n  - {name: a, at: [1]}\n",
                 ":3: at: expected 2 coordinates"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(World, HasThePlacesThatItNames) {
  const World world = parse_world(
      "segments: [[0, 0, 1, 1]]\n"
      "places: [{name: room A, at: [1.5, -2]}, {name: hall, at: [0, 4], heading: -1.5}]\n",
      "w");
  ASSERT_EQ(world.places.size(), 2U);
  EXPECT_EQ(world.places[0].name, "room A");
  EXPECT_EQ(world.places[0].position_m, Eigen::Vector2d(1.5, -2.0));
  EXPECT_EQ(world.places[1].name, "hall");
  EXPECT_FALSE(world.places[0].station_heading_rad);
  EXPECT_EQ(world.places[1].station_heading_rad, -1.5);
}

TEST(World, TheOfficeFloorHasRoomForTheRobotAtItsPlaces) {
  const World world = load_world(std::string(TOPOGEO_SHARE) + "/worlds/floor.world.yaml");
  EXPECT_EQ(world.places.size(), 9U);
  for (const NamedPlace& place : world.places) {
    EXPECT_GT(clearance_m(world, place.position_m), 0.6) << place.name;
  }
}

TEST(World, AMissingFileIsNamed) {
  try {
    load_world("/no/such.world.yaml");
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/no/such.world.yaml: "));
  }
  EXPECT_THROW(load_world(std::filesystem::temp_directory_path()), std::runtime_error);
}

TEST(World, EveryShippedWorldLoads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TOPOGEO_SHARE "/worlds")) {
    if (!entry.path().string().ends_with(".world.yaml")) continue;
    ++count;
    EXPECT_GE(load_world(entry.path()).tour_m.size(), 2U) << entry.path();
  }
  EXPECT_GE(count, 3);
}

}  // namespace
}  // namespace topogeo::world
