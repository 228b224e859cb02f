// Fusion as printed in the thesis (7.25-7.27), worked by hand: a corridor along x seen twice.
#include <algorithm>
#include <cstdint>
#include <set>

#include <gtest/gtest.h>

#include "topogeo/topomap/global_map_builder.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;

// A branch from x = 0 to `length_m` ahead of the robot, with a door at its end.
LocalMap corridor_view(std::uint32_t id, double length_m, double clearance_m) {
  LocalMap map;
  map.robot_id = "robot";
  map.id = id;
  map.nodes.resize(4);
  for (std::uint32_t k = 0; k < 4; ++k) map.nodes[k].id = k;
  for (const std::uint32_t k : {0U, 2U, 3U}) map.nodes[k].kind = NodeKind::kFictitious;
  map.nodes[1].kind = NodeKind::kDoor;
  map.nodes[1].position_m = {length_m, 0.0};
  map.nodes[1].clearance_m = clearance_m;
  map.nodes[2].position_m = {0.0, 1.0};  // these two widen the field of view to 2 m
  map.nodes[3].position_m = {0.0, -1.0};
  LocalBranch branch;
  branch.node_b = 1;
  for (int i = 0; 0.1 * i <= length_m + 1e-9; ++i) {
    branch.points.push_back({{0.1 * i, 0.0}, clearance_m});
  }
  map.branches.push_back(branch);
  return map;
}

GlobalMapBuilder pairs() {
  GlobalMapConfig config;
  config.fusion = FusionRule::kPairs;
  return GlobalMapBuilder(config);
}

TEST(PairFusion, EquivalentNodesBecomeTheMeanOfTheMapAndTheView) {
  GlobalMapBuilder builder = pairs();
  builder.integrate(corridor_view(0, 4.0, 0.50), Pose2{0, 0, 0});
  builder.integrate(corridor_view(1, 3.0, 0.60), Pose2{1.2, 0.1, 0});
  builder.integrate(corridor_view(2, 2.2, 0.55), Pose2{2.0, 0.05, 0});
  const GlobalMap map = builder.snapshot(1);
  const auto door = std::find_if(map.nodes.begin(), map.nodes.end(),
                                 [](const MapNode& n) { return n.kind == NodeKind::kDoor; });
  ASSERT_NE(door, map.nodes.end());
  // 7.25 and 7.26 twice: not the mean of the three views, because each later one counts half.
  EXPECT_NEAR(door->position_m.x(), 0.5 * (0.5 * (4.0 + 4.2) + 4.2), 1e-9);
  EXPECT_NEAR(door->position_m.y(), 0.5 * (0.5 * (0.0 + 0.1) + 0.05), 1e-9);
  EXPECT_NEAR(door->clearance_m, 0.5 * (0.55 + 0.55), 1e-9);
  EXPECT_EQ(door->observations, 3U);
}

TEST(PairFusion, TheNewerPointsStayWhereBothSawTheBranch) {
  GlobalMapBuilder builder = pairs();
  builder.integrate(corridor_view(0, 4.0, 0.5), Pose2{0, 0, 0});
  builder.integrate(corridor_view(1, 3.0, 0.5), Pose2{1.0, 0.04, 0});
  const GlobalMap map = builder.snapshot(1);
  ASSERT_EQ(map.branches.size(), 1U);
  const MapBranch& branch = map.branches.front();
  EXPECT_EQ(branch.observations, 2U);
  for (const BranchPoint& point : branch.points) {  // 7.27
    if (&point == &branch.points.back()) continue;  // the mean of both doors
    EXPECT_NEAR(point.position_m.y(), point.position_m.x() < 0.95 ? 0.0 : 0.04, 1e-9);
  }
  EXPECT_NEAR(branch.points.front().position_m.x(), 0.0, 1e-9);
  EXPECT_NEAR(branch.points.back().position_m.x(), 4.0, 1e-9);
}

TEST(PairFusion, WhatIsNotEquivalentIsAdded) {
  GlobalMapBuilder builder = pairs();
  builder.integrate(corridor_view(0, 4.0, 0.5), Pose2{0, 0, 0});
  builder.integrate(corridor_view(1, 3.0, 0.5), Pose2{2.0, 0, 1.5707963267948966});  // across
  const GlobalMap map = builder.snapshot(1);
  EXPECT_EQ(map.branches.size(), 2U);
  std::set<std::uint32_t> ids;
  for (const MapNode& node : map.nodes) EXPECT_TRUE(ids.insert(node.id).second);
  for (const MapBranch& branch : map.branches) {
    EXPECT_TRUE(ids.contains(branch.node_a) && ids.contains(branch.node_b));
  }
}

// The corridor and 0.3 m beyond its door, up to the length of objects near the corridor's end.
LocalMap view_beyond_door() {
  LocalMap map = corridor_view(0, 4.0, 0.5);
  map.nodes.push_back(map.nodes[0]);
  map.nodes[4].id = 4;
  map.nodes[4].position_m = {4.3, 0.0};
  LocalBranch beyond = map.branches.front();
  beyond.id = 1;
  beyond.node_a = 1;
  beyond.node_b = 4;
  beyond.points.clear();
  for (int i = 0; i <= 3; ++i) beyond.points.push_back({{4.0 + 0.1 * i, 0.0}, 0.5});
  map.branches.push_back(beyond);
  return map;
}

TEST(PairFusion, AShortBranchOfAViewDoesNotTakeThePlaceOfTheLongOneThatItGoesOnFrom) {
  GlobalMapBuilder builder = pairs();
  LocalMap view = view_beyond_door();
  for (std::uint32_t k = 0; k < 3; ++k) {
    view.id = k;
    builder.integrate(view, Pose2{0, 0, 0});
    double length_m = 0.0;
    for (const MapBranch& branch : builder.snapshot(1).branches) {
      for (std::size_t i = 1; i < branch.points.size(); ++i) {
        length_m += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
      }
    }
    EXPECT_NEAR(length_m, 4.3, 1e-9) << k + 1 << " views";
  }
}

}  // namespace
}  // namespace topogeo::topomap
