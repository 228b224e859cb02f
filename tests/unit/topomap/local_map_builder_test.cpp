#include "topogeo/topomap/local_map_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "voronoi/test_world.hpp"
#include "well_formed.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;
using test::expect_well_formed;
using test_world::Laser;
using test_world::scan_of;
using test_world::World;

LocalMap map_of(const scan::Scan& scan, const Pose2& T_robot_laser = {},
                const LocalMapConfig& config = {}) {
  voronoi::LocalVoronoi voronoi{voronoi::VoronoiConfig{}};
  LocalMap map;
  build_local_map(voronoi.compute(scan), scan, T_robot_laser, config, map);
  return map;
}

/// Everything counts as confirmed, as in the Thesis.
LocalMapConfig all_confirmed() {
  LocalMapConfig config;
  config.largest_hidden_share = 1.0;
  return config;
}

std::vector<LocalNode> nodes_of(const LocalMap& map, NodeKind kind) {
  std::vector<LocalNode> result;
  std::ranges::copy_if(map.nodes, std::back_inserter(result),
                       [&](const LocalNode& node) { return node.kind == kind; });
  return result;
}

// A room, a door 0.9 m wide in the wall at x = 2, and a wall behind it at x = 4.
const World kDoor{
    {-1, 2, 2, 2}, {2, 2, 2, 0.45}, {-1, -2, 2, -2}, {2, -2, 2, -0.45}, {4, -3, 4, 3}};

TEST(LocalMapBuilder, ADoorIsANodeWhereTheBranchIsNarrowest) {
  const LocalMap map = map_of(scan_of(kDoor, {0.7, 0.05, 0.0}));
  expect_well_formed(map);
  const auto doors = nodes_of(map, NodeKind::kDoor);
  ASSERT_EQ(doors.size(), 1U);
  EXPECT_NEAR(doors[0].position_m.x(), 1.3, 0.05);
  EXPECT_NEAR(doors[0].position_m.y(), -0.05, 0.03);
  EXPECT_NEAR(doors[0].clearance_m, 0.45, 0.03);
  EXPECT_TRUE(doors[0].in_main_graph);
  EXPECT_GE(map.branches.size(), 2U);
  // The node splits its branch in two.
  EXPECT_EQ(std::ranges::count_if(map.branches,
                                  [&](const LocalBranch& branch) {
                                    return branch.node_a == doors[0].id ||
                                           branch.node_b == doors[0].id;
                                  }),
            2);
  // Behind it, at equal distance from the door posts and the wall: (x - 2)^2 + 0.45^2 = (4 - x)^2.
  // The room behind is visible through the door only: the walls beside the wedge can be anywhere.
  EXPECT_TRUE(nodes_of(map, NodeKind::kReal).empty());
  const auto real =
      nodes_of(map_of(scan_of(kDoor, {0.7, 0.05, 0.0}), {}, all_confirmed()), NodeKind::kReal);
  ASSERT_EQ(real.size(), 1U);
  EXPECT_NEAR(real[0].position_m.x(), 2.949 - 0.7, 0.05);
}

// The robot in the doorway sees the whole circle around the place where the branches part.
TEST(LocalMapBuilder, WhatIsBehindADoorIsConfirmedOnceItIsSeen) {
  const World world{{-1, 2, 2, 2},     {2, 2, 2, 0.45}, {-1, -2, 2, -2},
                    {2, -2, 2, -0.45}, {4, -3, 4, 3},   {2, 3, 4, 3},
                    {2, -3, 4, -3},    {2, 2, 2, 3},    {2, -2, 2, -3}};
  const LocalMap before = map_of(scan_of(world, {0.7, 0.05, 0.0}));
  const LocalMap at =
      map_of(scan_of(world, {1.9, 0.0, 0.0}, {.beams = 720, .field_of_view_deg = 360.0}));
  const auto confirmed_beyond = [](const LocalMap& map, double x_m) {
    return std::ranges::any_of(map.branches, [&](const LocalBranch& branch) {
      return branch.confirmed && std::ranges::any_of(branch.points, [&](const BranchPoint& point) {
               return point.position_m.x() > x_m;
             });
    });
  };
  EXPECT_FALSE(confirmed_beyond(before, 2.75 - 0.7));
  EXPECT_TRUE(confirmed_beyond(at, 2.75 - 1.9));
}

TEST(LocalMapBuilder, AWiderMinimumIsANarrowingAndNoStateIsLookedForWhenSwitchedOff) {
  World wide = kDoor;
  wide[1].y1 = 0.8;
  wide[3].y1 = -0.8;
  const scan::Scan scan = scan_of(wide, {0.7, 0.0, 0.0});
  EXPECT_TRUE(nodes_of(map_of(scan), NodeKind::kDoor).empty());
  EXPECT_EQ(nodes_of(map_of(scan), NodeKind::kNarrowing).size(), 1U);
  LocalMapConfig off;
  off.find_states = false;
  EXPECT_TRUE(nodes_of(map_of(scan, {}, off), NodeKind::kNarrowing).empty());
  LocalMapConfig wide_doors;
  wide_doors.door_half_width_m = 0.9;
  EXPECT_EQ(nodes_of(map_of(scan, {}, wide_doors), NodeKind::kDoor).size(), 1U);
}

// A corridor 2 m wide that ends at x = 4 in a hall whose far wall is at x = 9.
TEST(LocalMapBuilder, TheMouthOfACorridorIsAHallCorridorPassage) {
  const World world{{-2, 1, 4, 1}, {4, 1, 4, 6}, {-2, -1, 4, -1}, {4, -1, 4, -6}, {9, -6, 9, 6}};
  const LocalMap map = map_of(scan_of(world, {1.0, 0.0, 0.0}));
  expect_well_formed(map);
  const auto passages = nodes_of(map, NodeKind::kHallCorridor);
  ASSERT_EQ(passages.size(), 1U);
  EXPECT_NEAR(passages[0].position_m.x(), 3.0, 0.1);
  EXPECT_NEAR(passages[0].clearance_m, 1.0, 0.05);
  EXPECT_TRUE(nodes_of(map, NodeKind::kDoor).empty());
  EXPECT_TRUE(nodes_of(map, NodeKind::kNarrowing).empty());
}

// The corridor widens to 3 m and narrows again: a maximum, but no end of a corridor 1.5 m long.
TEST(LocalMapBuilder, AMaximumOfTheClearanceMakesNoNode) {
  const World world{{-1, 1, 0.5, 1},      {0.5, 1, 1.5, 1.5}, {1.5, 1.5, 2.5, 1},
                    {2.5, 1, 3.5, 1},     {-1, -1, 0.5, -1},  {0.5, -1, 1.5, -1.5},
                    {1.5, -1.5, 2.5, -1}, {2.5, -1, 3.5, -1}, {20, -9, 20, 9}};
  const LocalMap map = map_of(scan_of(world));
  for (const LocalNode& node : map.nodes) {
    EXPECT_FALSE(node.kind == NodeKind::kDoor || node.kind == NodeKind::kNarrowing) << node.id;
    EXPECT_TRUE(node.kind != NodeKind::kHallCorridor || node.clearance_m < 1.2) << node.id;
  }
}

// The far wall is beyond the range limit: it only proves that the corridor is free.
TEST(LocalMapBuilder, ACorridorWithAnOpenEndHasTwoFictitiousNodesAndItsMouth) {
  const World corridor{{-3, 1, 5, 1}, {-3, -1, 5, -1}, {20, -9, 20, 9}};
  const LocalMap map = map_of(scan_of(corridor), {}, all_confirmed());
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 2U);
  EXPECT_EQ(map.nodes.size(), 3U);
  EXPECT_EQ(nodes_of(map, NodeKind::kFictitious).size(), 2U);
  const auto mouths = nodes_of(map, NodeKind::kHallCorridor);
  ASSERT_EQ(mouths.size(), 1U);
  // Readings on the walls are 0.2 m apart here, so the last may be that far from the corner.
  EXPECT_NEAR(mouths[0].position_m.x(), 5.0, 0.15);
  // Without the wall the beams along the axis have no return, which proves no free space: the
  // branch ahead is virtual.
  const LocalMap open = map_of(scan_of({corridor[0], corridor[1]}));
  EXPECT_FALSE(open.branches.empty());
  for (const LocalBranch& branch : open.branches) EXPECT_TRUE(branch.is_virtual);
}

// The circles of the first points reach behind the robot, those of the last beyond the range limit.
TEST(LocalMapBuilder, ABranchIsCutWhereItStopsBeingConfirmed) {
  const World corridor{{-3, 1, 5, 1}, {-3, -1, 5, -1}, {20, -9, 20, 9}};
  const LocalMap map = map_of(scan_of(corridor));
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 4U);
  EXPECT_FALSE(map.branches[0].confirmed);
  EXPECT_TRUE(map.branches[1].confirmed);  // up to the mouth of the corridor
  EXPECT_TRUE(map.branches[2].confirmed);
  EXPECT_FALSE(map.branches[3].confirmed);
  const auto ends = std::minmax(map.branches[1].points.front().position_m.x(),
                                map.branches[1].points.back().position_m.x());
  EXPECT_NEAR(ends.first, 0.8, 0.06);  // hidden by 0.2 m of a clearance of 1 m
  EXPECT_GT(ends.second, 4.0);
  for (const LocalBranch& branch : map.branches) EXPECT_TRUE(branch.in_main_graph);
}

TEST(LocalMapBuilder, AVirtualDiagramMakesOnlyVirtualElements) {
  for (const World& world : {World{}, World{{-3, 1, 30, 1}}}) {
    const LocalMap map = map_of(scan_of(world));
    expect_well_formed(map);
    ASSERT_EQ(map.branches.size(), 1U);
    EXPECT_TRUE(map.branches[0].is_virtual);
    EXPECT_EQ(nodes_of(map, NodeKind::kVirtual).size(), map.nodes.size());
  }
}

// Three branches along one line with gaps of 0.4 m and 1 m between them, and one of other groups.
TEST(LocalMapBuilder, WhatIsOffTheMainGraphIsKeptAndMarked) {
  voronoi::LocalVoronoiDiagram diagram;
  const auto add = [&](double x_m, double y_m, std::array<std::uint16_t, 2> groups) {
    const auto begin = static_cast<std::uint32_t>(diagram.points.size());
    for (const double step_m : {0.0, 0.3, 0.6}) {
      diagram.points.push_back({{x_m + step_m, y_m}, 1.0});
    }
    diagram.branches.push_back({.base_groups = groups, .points = {begin, begin + 3}});
  };
  add(2.6, 0.0, {0, 1});
  add(0.0, 0.1, {0, 1});
  add(1.0, 0.0, {0, 1});
  add(0.0, 0.4, {1, 2});
  LocalMap map;
  build_local_map(diagram, scan::Scan{}, {}, {}, map);
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 4U);
  EXPECT_FALSE(map.branches[0].in_main_graph);
  EXPECT_TRUE(map.branches[1].in_main_graph);
  EXPECT_TRUE(map.branches[2].in_main_graph);  // the same branch with a few beams missing
  EXPECT_FALSE(map.branches[3].in_main_graph);

  LocalMapConfig source;
  source.remove_off_main_graph = true;
  build_local_map(diagram, scan::Scan{}, {}, source, map);
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 2U);
  EXPECT_EQ(map.nodes.size(), 4U);
  EXPECT_EQ(map.branches[0].points.front().position_m, Eigen::Vector2d(0.0, 0.1));
}

// Maps that are built repeatedly into the same object, in another order, equal those built once.
TEST(LocalMapBuilder, AMapDoesNotDependOnWhatTheObjectsHeldBefore) {
  LocalMapBuilder builder{LocalMapConfig{}};
  LocalMap reused;
  for (const std::uint32_t seed : {3U, 1U, 4U, 1U, 5U, 9U, 2U, 6U, 5U, 3U}) {
    const scan::Scan scan = scan_of(test_world::random_world(seed));
    voronoi::LocalVoronoi voronoi{voronoi::VoronoiConfig{}};
    const auto diagram = voronoi.compute(scan);
    builder.build(diagram, scan, {}, reused);
    LocalMap once;
    build_local_map(diagram, scan, {}, {}, once);
    EXPECT_EQ(content_hash(reused), content_hash(once));
    EXPECT_EQ(reused.nodes.size(), once.nodes.size());
    expect_well_formed(reused);
  }
}

TEST(LocalMapBuilder, AnOuterBranchEndsBeforeTheFirstLongStep) {
  voronoi::LocalVoronoiDiagram diagram;
  for (const double x_m : {-2.0, -1.9, -0.1, 0.0, 0.1, 0.2, 1.0, 1.1}) {
    diagram.points.push_back({{x_m, 0.0}, 1.0});
  }
  diagram.branches.push_back({.base_groups = {0, 1}, .points = {0, 8}});
  LocalMap map;
  build_local_map(diagram, scan::Scan{}, {}, {}, map);
  ASSERT_EQ(map.branches.size(), 1U);
  ASSERT_EQ(map.branches[0].points.size(), 4U);
  EXPECT_EQ(map.branches[0].points.front().position_m.x(), -0.1);
  EXPECT_EQ(map.branches[0].points.back().position_m.x(), 0.2);
}

TEST(LocalMapBuilder, CoordinatesAreOfTheRobotHoweverTheLaserIsMounted) {
  const Laser laser{.beams = 720, .field_of_view_deg = 360.0};
  const Pose2 T_world_robot{0.7, 0.05, 0.1};
  const LocalMap straight = map_of(scan_of(kDoor, T_world_robot, laser), {}, all_confirmed());
  for (const Pose2& T_robot_laser : {Pose2{0.1, 0.0, 0.0}, Pose2{0.05, -0.1, 0.7}}) {
    const LocalMap map = map_of(scan_of(kDoor, T_world_robot * T_robot_laser, laser), T_robot_laser,
                                all_confirmed());
    expect_well_formed(map);
    EXPECT_EQ(map.T_robot_laser, T_robot_laser);
    for (const NodeKind kind : {NodeKind::kReal, NodeKind::kDoor}) {
      ASSERT_EQ(nodes_of(map, kind).size(), 1U);
      EXPECT_LT((nodes_of(map, kind)[0].position_m - nodes_of(straight, kind)[0].position_m).norm(),
                0.05);
    }
    for (const ScanPoint& point : map.points) {
      const Eigen::Vector2d at = T_world_robot * Eigen::Vector2d{point.x_m, point.y_m};
      const bool on_a_wall = std::abs(std::abs(at.y()) - 2.0) < 1e-4 ||
                             std::abs(at.x() - 2.0) < 1e-4 || std::abs(at.x() - 4.0) < 1e-4;
      EXPECT_TRUE(on_a_wall) << at.transpose();
    }
  }
}

TEST(LocalMapBuilder, AFieldOutsideItsRangeIsNamed) {
  LocalMapConfig config;
  config.largest_hidden_share = 1.5;
  try {
    const LocalMapBuilder builder{config};
    ADD_FAILURE() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "key 'local_map.largest_hidden_share' = '1.5': expected number between 0 and 1");
  }
}

TEST(LocalMapBuilder, PointsAreTheReadingsUpToTheLimitInBeamOrder) {
  scan::Scan scan;
  scan.angle_min_rad = 0.0;
  scan.angle_step_rad = M_PI / 2.0;
  scan.ranges_m = {2.0F, scan::Scan::kNoReturn, 51.0F};
  LocalMap map;
  map.points.resize(5);
  build_local_map({}, scan, {0.5, 0.0, 0.0}, {}, map);
  ASSERT_EQ(map.points.size(), 1U);
  EXPECT_FLOAT_EQ(map.points[0].x_m, 2.5F);
  scan.ranges_m[2] = 49.0F;
  build_local_map({}, scan, {}, {}, map);
  ASSERT_EQ(map.points.size(), 2U);
  EXPECT_FLOAT_EQ(map.points[1].x_m, -49.0F);
}

TEST(LocalMapBuilder, RandomScenesGiveWellFormedMapsAndTheSameHashTwice) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    const scan::Scan scan = scan_of(test_world::random_world(seed));
    const LocalMap map = map_of(scan);
    expect_well_formed(map);
    EXPECT_EQ(content_hash(map), content_hash(map_of(scan)));
  }
}

}  // namespace
}  // namespace topogeo::topomap
