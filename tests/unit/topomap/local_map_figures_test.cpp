// The figures of the Thesis's chapter 5 that explain a rule, each with and without that rule.
//
// The scenes are in share/figures; walls are named by letters, see figure_scenes.hpp.
// Positions are worked out by hand from whole walls, in the robot frame (x forward, y left,
// metres).
#include <algorithm>
#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "figure_maps.hpp"

namespace topogeo::topomap {
namespace {

using figure_scenes::expect_node;
using figure_scenes::load_scene;
using figure_scenes::MapSeen;
using figure_scenes::Scene;
using figure_scenes::see;
using figure_scenes::see_map;
using figure_scenes::source_config;
using figure_scenes::source_map_config;
using testing::ElementsAre;

LocalMapConfig without_states() {
  LocalMapConfig config = source_map_config();
  config.find_states = false;
  return config;
}

// Figure 5.1: node 1 of the objects 1, 2, 4 and node 2 of 2, 3, 4 share 2 and 4, so branch 3 joins
// them; branches 1, 2 and 4 end at a fictitious node. The objects 1 to 4 are A to D. Node 1: (1.1 -
// y)^2 + 0.45^2 = (y + 0.9)^2. Node 2 is equally far from the end (1.3, 2.5) of C and from the
// jambs: (y - 1.1)^2 + 0.45^2 = (2.5 - y)^2 + 0.35^2.
TEST(FiguresOfChapter5, Figure1NodesThatShareTwoGroupsAreJoinedByABranch) {
  const Scene scene = load_scene("5_01");
  EXPECT_THAT(see(scene, source_config()).groups, ElementsAre("A", "B", "C", "D"));
  const MapSeen seen = see_map(scene, source_config(), without_states());
  EXPECT_THAT(seen.node_names(), ElementsAre("fictitious A|B", "fictitious A|D", "fictitious B|C",
                                             "real A|B|D", "real B|C|D"));
  expect_node(seen, "real A|B|D", {0.95, 0.1506});
  expect_node(seen, "real B|C|D", {0.95, 1.7714});
  EXPECT_THAT(seen.branches,
              ElementsAre("A|B: real A|B|D - fictitious A|B", "A|D: real A|B|D - fictitious A|D",
                          "B|C: real B|C|D - fictitious B|C", "B|D: real B|C|D - real A|B|D"));

  // The search for states of 5.2.2.1 puts the door into branch 3.
  const MapSeen with_states = see_map(scene, source_config(), source_map_config());
  expect_node(with_states, "door B|D", {0.95, 1.1}, 0.05);
  EXPECT_THAT(with_states.branches,
              ElementsAre("A|B: real A|B|D - fictitious A|B", "A|D: real A|B|D - fictitious A|D",
                          "B|C: real B|C|D - fictitious B|C", "B|D: real A|B|D - door B|D",
                          "B|D: real B|C|D - door B|D"));
}

// Figure 5.2: the node of the objects 1, 3, 4, 5 with four branches is the main graph; the fifth
// branch, of 1 and 2, is off it, and removed when 5.2.2 is followed literally. The objects 1 to 5
// are AF, B, C, D, E. The jambs are equally far from (0.525, 0.1).
TEST(FiguresOfChapter5, Figure2ABranchThatNothingJoinsIsOffTheMainGraph) {
  const Scene scene = load_scene("5_02");
  const auto diagram = see(scene, source_config());
  EXPECT_THAT(diagram.groups, ElementsAre("AF", "B", "C", "D", "E"));
  EXPECT_THAT(diagram.node_names(), ElementsAre("AF|C|D|E"));
  EXPECT_EQ(diagram.branches.size(), 5U);

  const MapSeen seen = see_map(scene, source_config(), without_states());
  expect_node(seen, "real AF|C|D|E", {0.525, 0.1});
  EXPECT_THAT(seen.node_names(),
              ElementsAre("fictitious AF|B (off)", "fictitious AF|B (off)", "fictitious AF|C",
                          "fictitious AF|E", "fictitious C|D", "fictitious D|E", "real AF|C|D|E"));
  EXPECT_THAT(
      seen.branches,
      ElementsAre("AF|B: fictitious AF|B - fictitious AF|B (off)",
                  "AF|C: real AF|C|D|E - fictitious AF|C", "AF|E: real AF|C|D|E - fictitious AF|E",
                  "C|D: real AF|C|D|E - fictitious C|D", "D|E: real AF|C|D|E - fictitious D|E"));
}

// Figure 5.4: in the hall the clearance falls, sqrt((1.5 - x)^2 + 1) on the axis y = 0.1; in the
// corridor it stays at 1. The passage is at the start of the corridor, x = 1.5.
TEST(FiguresOfChapter5, Figure4FromAHallIntoACorridorThereIsAStateAtTheMouth) {
  const Scene scene = load_scene("5_04");
  EXPECT_THAT(see(scene, source_config()).groups, ElementsAre("AEF", "BCD"));
  const MapSeen without = see_map(scene, source_config(), without_states());
  EXPECT_THAT(without.branches, ElementsAre("AEF|BCD: fictitious AEF|BCD - fictitious AEF|BCD"));

  const MapSeen with = see_map(scene, source_config(), source_map_config());
  EXPECT_THAT(with.node_names(),
              ElementsAre("fictitious AEF|BCD", "fictitious AEF|BCD", "hall-corridor AEF|BCD"));
  expect_node(with, "hall-corridor AEF|BCD", {1.5, 0.1}, 0.02);
  EXPECT_NEAR(with.node("hall-corridor AEF|BCD")->clearance_m, 1.0, 0.03);
  EXPECT_THAT(with.branches, ElementsAre("AEF|BCD: hall-corridor AEF|BCD - fictitious AEF|BCD",
                                         "AEF|BCD: hall-corridor AEF|BCD - fictitious AEF|BCD"));

  LocalMapConfig high = source_map_config();
  high.hall_rise_m = 1.0;  // in the hall the clearance is at most 0.8 m larger
  EXPECT_EQ(see_map(scene, source_config(), high).branches, without.branches);
}

// Figure 5.4 with the distances as drawn: they fall up to the mouth and then stay constant.
TEST(FiguresOfChapter5, Figure4ClearancesFallInTheHallAndStayInTheCorridor) {
  const Scene scene = load_scene("5_04");
  const LocalMap map = figure_scenes::make_map(figure_scenes::scan_of(scene.world, {}),
                                               source_config(), without_states())
                           .map;
  ASSERT_EQ(map.branches.size(), 1U);
  for (const BranchPoint& point : map.branches[0].points) {
    const double x_m = point.position_m.x();
    EXPECT_NEAR(point.clearance_m, std::hypot(std::max(1.5 - x_m, 0.0), 1.0), 0.02) << x_m;
  }
}

// Figure 5.5: the clearance of the branch through the door is sqrt(0.45^2 + (y - 1.1)^2) with its
// minimum between the jambs, at (1.05, 1.1).
TEST(FiguresOfChapter5, Figure5TheMinimumOfTheClearanceIsADoor) {
  const Scene scene = load_scene("5_05");
  EXPECT_THAT(see(scene, source_config()).groups, ElementsAre("A", "B", "D", "C"));
  const MapSeen without = see_map(scene, source_config(), without_states());
  EXPECT_THAT(without.node_names(), ElementsAre("fictitious A|B", "fictitious A|C",
                                                "fictitious B|D", "real A|B|C", "real B|C|D"));
  expect_node(without, "real A|B|C", {1.05, 0.1506});
  expect_node(without, "real B|C|D", {1.05, 1.7337});

  const MapSeen with = see_map(scene, source_config(), source_map_config());
  EXPECT_THAT(with.node_names(), ElementsAre("door B|C", "fictitious A|B", "fictitious A|C",
                                             "fictitious B|D", "real A|B|C", "real B|C|D"));
  expect_node(with, "door B|C", {1.05, 1.1}, 0.05);
  EXPECT_NEAR(with.node("door B|C")->clearance_m, 0.45, 0.02);
  EXPECT_THAT(with.branches,
              ElementsAre("A|B: real A|B|C - fictitious A|B", "A|C: real A|B|C - fictitious A|C",
                          "B|C: real A|B|C - door B|C", "B|C: real B|C|D - door B|C",
                          "B|D: real B|C|D - fictitious B|D"));

  LocalMapConfig narrow = source_map_config();
  narrow.door_half_width_m = 0.4;  // the same state, but too wide for a door
  EXPECT_TRUE(see_map(scene, source_config(), narrow).node("narrowing B|C").has_value());
  LocalMapConfig flat = source_map_config();
  flat.state_rise_m = 0.65;  // the clearance rises by 0.6 m in the corridor, 0.33 m in the room
  EXPECT_EQ(see_map(scene, source_config(), flat).node_names(), without.node_names());
}

// Figure 5.7: points beyond the gap in the branch ahead are cut off (5.5), and the narrowing
// between the tip (1.6, 0.65) of the door leaf and the wall y = -0.9 is a state: (1.6, -0.125).
TEST(FiguresOfChapter5, Figure7FarPointsAreCutAndTheNarrowingIsAState) {
  const Scene scene = load_scene("5_07");
  EXPECT_THAT(see(scene, source_config()).groups, ElementsAre("A", "B", "CDE", "F"));
  const std::array cut{
      "A|B: real A|B|CDE|F - fictitious A|B", "A|F: real A|B|CDE|F - fictitious A|F",
      "B|CDE: fictitious B|CDE - fictitious B|CDE (off)",
      "B|CDE: real A|B|CDE|F - fictitious B|CDE", "CDE|F: real A|B|CDE|F - fictitious CDE|F"};
  const MapSeen without = see_map(scene, source_config(), without_states());
  expect_node(without, "real A|B|CDE|F", {0.5, 0.1});
  EXPECT_THAT(without.branches, testing::ElementsAreArray(cut));

  LocalMapConfig uncut = without_states();
  uncut.separated_m = 2.0;  // the gap is about 0.8 m wide
  for (const std::string& branch : see_map(scene, source_config(), uncut).branches) {
    EXPECT_THAT(branch, testing::Not(testing::HasSubstr("(off)")));
  }

  const MapSeen with = see_map(scene, source_config(), source_map_config());
  expect_node(with, "narrowing B|CDE", {1.6, -0.125}, 0.05);
  EXPECT_NEAR(with.node("narrowing B|CDE")->clearance_m, 0.775, 0.02);
  EXPECT_THAT(with.branches, ElementsAre("A|B: real A|B|CDE|F - fictitious A|B",
                                         "A|F: real A|B|CDE|F - fictitious A|F",
                                         "B|CDE: fictitious B|CDE - fictitious B|CDE (off)",
                                         "B|CDE: narrowing B|CDE - fictitious B|CDE",
                                         "B|CDE: real A|B|CDE|F - narrowing B|CDE",
                                         "CDE|F: real A|B|CDE|F - fictitious CDE|F"));
}

// Figure 4.7 as local maps: every node and branch is virtual.
TEST(FiguresOfChapter5, WithoutTwoGroupsEverythingIsVirtual) {
  for (const std::string number : {"4_07a", "4_07b"}) {
    const LocalMap map =
        figure_scenes::make_map(figure_scenes::scan_of(load_scene(number).world, {}),
                                source_config(), source_map_config())
            .map;
    ASSERT_EQ(map.branches.size(), 1U) << number;
    EXPECT_TRUE(map.branches[0].is_virtual);
    ASSERT_EQ(map.nodes.size(), 2U);
    for (const LocalNode& node : map.nodes) EXPECT_EQ(node.kind, NodeKind::kVirtual);
  }
}

}  // namespace
}  // namespace topogeo::topomap
