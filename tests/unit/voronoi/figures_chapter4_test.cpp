// The figures of the Thesis's chapter 4 that explain a rule, each with and without that rule.
//
// The scenes are in share/figures; walls are named by letters, see figure_scenes.hpp.
// Positions are worked out by hand from whole walls, in the laser frame (x forward, y left,
// metres).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/voronoi/distance_error.hpp"

#include "figure_scenes.hpp"

namespace topogeo::voronoi {
namespace {

using figure_scenes::expect_node;
using figure_scenes::load_scene;
using figure_scenes::only_splitting;
using figure_scenes::scan_of;
using figure_scenes::Scene;
using figure_scenes::see;
using figure_scenes::Seen;
using figure_scenes::source_config;
using testing::ElementsAre;
using testing::IsEmpty;

// 4.7(a): no group, so two virtual ones at 0.6 m to the right and left, parallel to the motion.
TEST(FiguresOfChapter4, Figure7aNoGroupGivesTwoVirtualGroups) {
  const Scene scene = load_scene("4_07a");
  LocalVoronoi voronoi(source_config());
  const LocalVoronoiDiagram diagram = voronoi.compute(scan_of(scene.world, {}));
  EXPECT_TRUE(diagram.is_virtual);
  EXPECT_THAT(figure_scenes::group_names(diagram, scene.world, {}), ElementsAre("*", "*"));
  for (const GroupPoint& point : diagram.groups.points) {
    EXPECT_NEAR(std::abs(point.position_m.y()), 0.6, 1e-9);
  }
  EXPECT_THAT(diagram.nodes, IsEmpty());
  ASSERT_EQ(diagram.branches.size(), 1U);
  for (const DiagramPoint& point : diagram.points) EXPECT_NEAR(point.position_m.y(), 0.0, 0.01);
  EXPECT_GT(diagram.points.back().position_m.x() - diagram.points.front().position_m.x(), 3.5);

  VoronoiConfig farther = source_config();
  farther.range_limit_m = 10.0;  // the walls at 9 m are now objects
  const Seen seen = see(scene, farther);
  EXPECT_FALSE(seen.is_virtual);
  EXPECT_EQ(seen.groups.size(), 3U);
}

// 4.7(b): one wall at y = 1.3, so the virtual group is its image at y = -1.3.
TEST(FiguresOfChapter4, Figure7bOneGroupGivesOneVirtualGroup) {
  const Scene scene = load_scene("4_07b");
  LocalVoronoi voronoi(source_config());
  const LocalVoronoiDiagram diagram = voronoi.compute(scan_of(scene.world, {}));
  EXPECT_TRUE(diagram.is_virtual);
  ASSERT_THAT(figure_scenes::group_names(diagram, scene.world, {}), ElementsAre("A", "*"));
  const PointRun& run = diagram.groups.groups[1];
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    EXPECT_NEAR(diagram.groups.points[i].position_m.y(), -1.3, 1e-5);
  }
  ASSERT_EQ(diagram.branches.size(), 1U);
  for (const DiagramPoint& point : diagram.points) EXPECT_NEAR(point.position_m.y(), 0.0, 0.02);

  VoronoiConfig farther = source_config();
  farther.range_limit_m = 10.0;
  EXPECT_FALSE(see(scene, farther).is_virtual);
}

// Rule 4.7. The four corners are equally far from the middle of the crossing (2, 0.1).
TEST(FiguresOfChapter4, Figure8SplitAtDiscontinuitiesTellsFourObjectsApart) {
  const Scene scene = load_scene("4_08");
  const Seen with = see(scene, only_splitting());
  EXPECT_THAT(with.groups, ElementsAre("A", "BC", "DE", "F"));
  EXPECT_THAT(with.node_names(), ElementsAre("A|BC|DE|F"));
  expect_node(with, "A|BC|DE|F", {2.0, 0.1});
  EXPECT_NEAR(with.nodes[0].clearance_m, std::hypot(0.8, 1.0), 0.02);
  EXPECT_THAT(with.branches, ElementsAre("A|BC: A|BC|DE|F - open", "A|F: A|BC|DE|F - open",
                                         "BC|DE: A|BC|DE|F - open", "DE|F: A|BC|DE|F - open"));

  VoronoiConfig off = only_splitting();
  off.split_discontinuities = false;
  const Seen without = see(scene, off);
  EXPECT_THAT(without.groups, ElementsAre("ABC", "DEF"));
  EXPECT_THAT(without.nodes, IsEmpty());
  EXPECT_THAT(without.branches, ElementsAre("ABC|DEF: open - open"));
}

// Rule 4.8, "from 6 to 5": the branch between door leaf and wardrobe is removed. Beside the door
// the jambs and the right wall are equally far: (1.1 - y)^2 + 0.45^2 = (y + 0.9)^2.
TEST(FiguresOfChapter4, Figure10JoiningContiguousGroupsRemovesTheBranchOfANarrowGap) {
  const Scene scene = load_scene("4_10");
  const Seen without = see(scene, only_splitting());
  EXPECT_THAT(without.groups, ElementsAre("A", "BC", "DE", "FG", "H", "I"));
  EXPECT_THAT(without.node_names(), ElementsAre("A|BC|DE|FG", "A|FG|I"));
  EXPECT_THAT(without.branches,
              ElementsAre("A|BC: A|BC|DE|FG - open", "A|FG: A|BC|DE|FG - A|FG|I",
                          "A|I: A|FG|I - open", "BC|DE: A|BC|DE|FG - open",
                          "DE|FG: A|BC|DE|FG - open", "FG|H: open - open", "FG|I: A|FG|I - open"));

  VoronoiConfig config = only_splitting();
  config.join_contiguous = true;
  const Seen with = see(scene, config);
  EXPECT_THAT(with.groups, ElementsAre("A", "BC", "DE", "FGH", "I"));
  EXPECT_THAT(with.node_names(), ElementsAre("A|BC|DE|FGH", "A|FGH|I"));
  expect_node(with, "A|BC|DE|FGH", {2.7, 0.1});
  expect_node(with, "A|FGH|I", {0.95, 0.1506});
  EXPECT_THAT(with.branches, ElementsAre("A|BC: A|BC|DE|FGH - open", "A|FGH: A|BC|DE|FGH - A|FGH|I",
                                         "A|I: A|FGH|I - open", "BC|DE: A|BC|DE|FGH - open",
                                         "DE|FGH: A|BC|DE|FGH - open", "FGH|I: A|FGH|I - open"));

  config.contiguous_m = 0.3;  // the gap is 0.35 m
  EXPECT_EQ(see(scene, config).groups.size(), 6U);
}

// Rule 4.9, fewer than 6: A and C on either side of the slit are one object; readings between them
// are dropped, with their branches. Nodes without the rule: before the slit
// (1.1 - y)^2 = 0.225^2 + (y + 0.9)^2, behind it (y + 1.8)^2 = 0.225^2 + (y + 0.9)^2.
TEST(FiguresOfChapter4, Figure11JoiningAlternateGroupsRemovesTheBranchThroughASlit) {
  const Scene scene = load_scene("4_11");
  VoronoiConfig config = only_splitting();
  config.join_contiguous = true;
  const Seen without = see(scene, config);
  EXPECT_THAT(without.groups, ElementsAre("A", "B", "C", "DJ", "EF", "G"));
  EXPECT_THAT(without.node_names(), ElementsAre("A|B|C", "A|C|G", "C|DJ|EF|G"));
  expect_node(without, "A|C|G", {0.425, 0.0873});
  expect_node(without, "A|B|C", {0.425, -1.3218});
  EXPECT_THAT(without.branches,
              ElementsAre("A|C: A|B|C - A|C|G", "A|G: A|C|G - open", "B|C: A|B|C - open",
                          "C|DJ: C|DJ|EF|G - open", "C|G: A|C|G - C|DJ|EF|G",
                          "DJ|EF: C|DJ|EF|G - open", "EF|G: C|DJ|EF|G - open"));

  config.join_alternate = true;
  for (const bool behind_only : {false, true}) {  // the part in between is seen through the gap
    config.alternate_behind_only = behind_only;
    const Seen with = see(scene, config);
    EXPECT_THAT(with.groups, ElementsAre("AC", "DJ", "EF", "G"));
    EXPECT_THAT(with.node_names(), ElementsAre("AC|DJ|EF|G"));
    expect_node(with, "AC|DJ|EF|G", {2.7, 0.1});
    EXPECT_THAT(with.branches, ElementsAre("AC|DJ: AC|DJ|EF|G - open", "AC|G: AC|DJ|EF|G - open",
                                           "DJ|EF: AC|DJ|EF|G - open", "EF|G: AC|DJ|EF|G - open"));
  }

  config.alternate_m = 0.4;  // the slit is 0.45 m wide
  EXPECT_EQ(see(scene, config).groups.size(), 6U);
}

// Rule 4.10: the post is one reading. With it, its front (3.182, -0.2225), the corner (1.2, 1.1)
// and one of the walls y = -0.9 and y = 2.2 are equally far from two nodes; without it, the corner
// and both walls are equally far from (1.2 + sqrt(1.55^2 - 0.45^2), 0.65).
TEST(FiguresOfChapter4, Figure12DroppingSmallGroupsMendsTheDiagram) {
  const Scene scene = load_scene("4_12");
  const Seen without = see(scene, only_splitting());
  EXPECT_THAT(without.groups, ElementsAre("A", "a", "B", "C"));
  EXPECT_THAT(without.node_names(), ElementsAre("A|C|a", "B|C|a"));
  expect_node(without, "A|C|a", {2.100, 0.3025});
  expect_node(without, "B|C|a", {2.4925, 0.8906});
  EXPECT_THAT(without.branches,
              ElementsAre("A|C: A|C|a - open", "A|a: A|C|a - open", "B|C: B|C|a - open",
                          "B|a: B|C|a - open", "C|a: A|C|a - B|C|a"));

  VoronoiConfig config = only_splitting();
  config.drop_small = true;
  config.min_group_points = 1;  // "equal or below": a group of one reading goes
  const Seen with = see(scene, config);
  EXPECT_THAT(with.groups, ElementsAre("A", "B", "C"));
  EXPECT_THAT(with.node_names(), ElementsAre("A|B|C"));
  expect_node(with, "A|B|C", {2.6832, 0.65});
  EXPECT_THAT(with.branches,
              ElementsAre("A|B: A|B|C - open", "A|C: A|B|C - open", "B|C: A|B|C - open"));

  config.min_group_points = 0;
  EXPECT_EQ(see(scene, config).groups.size(), 4U);
}

// Rule 4.11: the walls A of the corridor and B of the hall are one object behind the corner. Equal
// distances to the corner (1.5, -0.9), y = 1.1 and y = -1.6: (1.5 + sqrt(1.35^2 - 0.65^2), -0.25).
TEST(FiguresOfChapter4, Figure15AHiddenZoneOnTheRightJoinsTheWallsOfACorner) {
  const Scene scene = load_scene("4_15");
  VoronoiConfig config = source_config();
  config.join_hidden_zones = false;
  const Seen without = see(scene, config);
  EXPECT_THAT(without.groups, ElementsAre("A", "B", "C"));
  EXPECT_THAT(without.node_names(), ElementsAre("A|B|C"));
  expect_node(without, "A|B|C", {2.6832, -0.25});
  EXPECT_THAT(without.branches,
              ElementsAre("A|B: A|B|C - open", "A|C: A|B|C - open", "B|C: A|B|C - open"));

  const Seen with = see(scene, source_config());
  EXPECT_THAT(with.groups, ElementsAre("AB", "C"));
  EXPECT_THAT(with.nodes, IsEmpty());
  EXPECT_THAT(with.branches, ElementsAre("AB|C: open - open"));
}

// Rule 4.12 is rule 4.11 for the left: the mirror image of figure 4.15.
TEST(FiguresOfChapter4, Figure15MirroredAHiddenZoneOnTheLeftJoinsTheWallsOfACorner) {
  const Scene scene = figure_scenes::mirrored(load_scene("4_15"));
  VoronoiConfig config = source_config();
  config.join_hidden_zones = false;
  const Seen without = see(scene, config);
  EXPECT_THAT(without.groups, ElementsAre("C", "B", "A"));
  expect_node(without, "A|B|C", {2.6832, 0.25});
  const Seen with = see(scene, source_config());
  EXPECT_THAT(with.groups, ElementsAre("C", "AB"));
  EXPECT_THAT(with.branches, ElementsAre("AB|C: open - open"));
}

// Rules 4.11 and 4.12 lose the side corridors from afar; nearby, they reappear.
TEST(FiguresOfChapter4, Figure16HiddenZonesLoseOpeningsFromAfarButNotNearBy) {
  const Scene scene = load_scene("4_16");
  VoronoiConfig config = source_config();
  config.join_hidden_zones = false;
  const std::array branches{"A|BC: A|BC|DE|F - open", "A|F: A|BC|DE|F - open",
                            "BC|DE: A|BC|DE|F - open", "DE|F: A|BC|DE|F - open"};
  const Seen without = see(scene, config);
  EXPECT_THAT(without.groups, ElementsAre("A", "BC", "DE", "F"));
  expect_node(without, "A|BC|DE|F", {2.0, 0.1});
  EXPECT_THAT(without.branches, testing::ElementsAreArray(branches));

  const Seen with = see(scene, source_config());
  EXPECT_THAT(with.groups, ElementsAre("ABC", "DEF"));
  EXPECT_THAT(with.nodes, IsEmpty());
  EXPECT_THAT(with.branches, ElementsAre("ABC|DEF: open - open"));

  const Seen nearer = see(scene, source_config(), figure_scenes::half_turn(), 1);
  EXPECT_THAT(nearer.groups, ElementsAre("A", "BC", "DE", "F"));
  expect_node(nearer, "A|BC|DE|F", {1.0, 0.1});  // one metre on
  EXPECT_THAT(nearer.branches, testing::ElementsAreArray(branches));
}

double distance_to_set(const LocalVoronoiDiagram& diagram, std::uint16_t group,
                       const Eigen::Vector2d& at) {
  double nearest_m = 1e9;
  const PointRun& run = diagram.groups.groups[group];
  for (std::uint32_t i = run.begin; i < run.end; ++i) {
    nearest_m = std::min(nearest_m, (diagram.groups.points[i].position_m - at).norm());
  }
  return nearest_m;
}

// Three groups, one node equally far from all, three branches each equally far from two (4.23,
// 4.24). The Thesis's objects 1, 2, 3 are A, B, C; its branches 1, 2, 3 are A|C, A|B, B|C.
TEST(FiguresOfChapter4, Figure20NodeAndBranchesAreEquallyFarFromTheirBaseGroups) {
  const Scene scene = load_scene("4_20");
  const Seen seen = see(scene, source_config());
  EXPECT_THAT(seen.groups, ElementsAre("A", "B", "C"));
  EXPECT_THAT(seen.node_names(), ElementsAre("A|B|C"));
  expect_node(seen, "A|B|C", {1.45, 0.1506});
  EXPECT_THAT(seen.branches,
              ElementsAre("A|B: A|B|C - open", "A|C: A|B|C - open", "B|C: A|B|C - open"));

  LocalVoronoi voronoi(source_config());
  const LocalVoronoiDiagram diagram = voronoi.compute(scan_of(scene.world, {}));
  const double limit_m = 2.0 * largest_distance_error_m(0.05);
  for (std::uint16_t group = 0; group < 3; ++group) {
    EXPECT_NEAR(distance_to_set(diagram, group, diagram.nodes[0].position_m),
                diagram.nodes[0].clearance_m, limit_m);
  }
  for (const DiagramBranch& branch : diagram.branches) {
    for (const DiagramPoint& point : diagram.points_of(branch)) {
      for (const std::uint16_t group : branch.base_groups) {
        EXPECT_NEAR(distance_to_set(diagram, group, point.position_m), point.clearance_m, limit_m);
      }
    }
  }
}

// With a threshold of 4.8 above the width of the door, B and C are one object: no node.
TEST(FiguresOfChapter4, Figure20WithoutADoorWideEnoughThereIsNoNode) {
  VoronoiConfig config = source_config();
  config.contiguous_m = 1.0;  // wider than the door
  const Seen seen = see(load_scene("4_20"), config);
  EXPECT_THAT(seen.groups, ElementsAre("A", "BC"));
  EXPECT_THAT(seen.nodes, IsEmpty());
  EXPECT_THAT(seen.branches, ElementsAre("A|BC: open - open"));
}

}  // namespace
}  // namespace topogeo::voronoi
