// Routes along branches with obstructions: no-go, slow and one-way zones, obstacles on them now,
// obstacles of the grid beside them; and virtual branches.
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/route_planner.hpp"

#include "branch_maps.hpp"
#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using topomap::GlobalMap;

// A rectangle from (x0, y0) to (x1, y1).
DrawnZone rectangle(double x0, double y0, double x1, double y1, ZoneKind kind, double value = 0.0) {
  return {"zone", {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, kind, value};
}

//  3 ----11---- 4      a ring of 20 x 10 m, clearance 1 m
//  |            |
//  12           13
//  |            |
//  1 ----10---- 2
GlobalMap square() {
  GlobalMap map;
  add_map_node(map, 1, 0, 0);
  add_map_node(map, 2, 20, 0);
  add_map_node(map, 3, 0, 10);
  add_map_node(map, 4, 20, 10);
  add_map_branch(map, 10, 1, 2);
  add_map_branch(map, 11, 3, 4);
  add_map_branch(map, 12, 1, 3);
  add_map_branch(map, 13, 2, 4);
  return map;
}

PlanScene with_zones(const std::vector<DrawnZone>& zones) {
  PlanScene scene;
  scene.zones = zones;
  return scene;
}

TEST(BranchRoutes, GoRoundWhatIsFilledAndANoGoZone) {
  const GlobalMap map = square();
  ASSERT_THAT(plan(map, {5, 0}, {15, 0}).route.branch_ids, ElementsAre(10));
  const std::vector<Eigen::Vector2d> filled_m{{10.05, 0.25}};
  PlanScene scene;
  scene.filled_m = filled_m;
  const PlanResult round = plan(map, {5, 0}, {15, 0}, {}, scene);
  ASSERT_TRUE(round.found()) << round.reason;
  EXPECT_THAT(round.route.branch_ids, ElementsAre(10, 12, 11, 13, 10));
  EXPECT_NEAR(round.route.length_m, 5 + 10 + 20 + 10 + 5, 1e-9);
  const std::vector<Eigen::Vector2d> beside_m{{10.05, 0.55}};
  scene.filled_m = beside_m;
  EXPECT_NEAR(plan(map, {5, 0}, {15, 0}, {}, scene).route.length_m, 10.0, 1e-9);
  const std::vector<DrawnZone> wet{rectangle(9, 0.2, 11, 3, ZoneKind::kNoGo)};
  EXPECT_NEAR(plan(map, {5, 0}, {15, 0}, {}, with_zones(wet)).route.length_m, 50.0, 1e-9);
  const std::vector<DrawnZone> both{rectangle(9, -1, 11, 11, ZoneKind::kNoGo)};
  const PlanResult none = plan(map, {5, 0}, {15, 0}, {}, with_zones(both));
  EXPECT_EQ(none.status, PlanStatus::kClosed);
  EXPECT_THAT(none.reason, HasSubstr("closed now or by a zone"));
}

TEST(BranchRoutes, LeaveTheStretchBeforeABlockageToBothSides) {
  const GlobalMap map = square();
  const std::vector<Eigen::Vector2d> filled_m{{10.05, 0.05}};
  PlanScene scene;
  scene.filled_m = filled_m;
  // The robot has stopped so close to it that its place on the branch is blocked.
  const PlanResult back = plan(map, {9.8, 0.3}, {0, 5}, {}, scene);
  ASSERT_TRUE(back.found()) << back.reason;
  EXPECT_LT(back.start->nearest.position_m.x(), 9.8);
  EXPECT_NEAR(back.route.points.back().position_m.y(), 5.0, 1e-9);
  EXPECT_EQ(plan(map, {5, 0}, {10, 0.1}, {}, scene).status, PlanStatus::kGoalShut);
}

TEST(BranchRoutes, TakeASlowZoneOnlyWhereItIsFaster) {
  const GlobalMap map = square();
  std::vector<DrawnZone> ramp{rectangle(8, -1, 12, 1, ZoneKind::kSlow, 0.3)};
  EXPECT_NEAR(plan(map, {5, 0}, {15, 0}, {}, with_zones(ramp)).route.length_m, 10.0, 1e-9);
  ramp[0].value = 0.03;  // twenty times slower
  EXPECT_NEAR(plan(map, {5, 0}, {15, 0}, {}, with_zones(ramp)).route.length_m, 50.0, 1e-9);
}

TEST(BranchRoutes, TakeAPreferredLaneThatIsNotMuchLonger) {
  const GlobalMap map = square();
  std::vector<DrawnZone> lanes{rectangle(-1, 9, 21, 11, ZoneKind::kPreferred)};
  EXPECT_NEAR(plan(map, {0, 3}, {20, 3}, {}, with_zones(lanes)).route.length_m, 26.0, 1e-9);
  lanes.push_back(rectangle(-1, 3, 1, 9, ZoneKind::kPreferred));
  lanes.push_back(rectangle(19, 3, 21, 9, ZoneKind::kPreferred));
  EXPECT_NEAR(plan(map, {0, 3}, {20, 3}, {}, with_zones(lanes)).route.length_m, 34.0, 1e-9);
}

TEST(BranchRoutes, PassAOneWayZoneAlongItsHeadingAndAcrossIt) {
  const GlobalMap map = square();
  const std::vector<DrawnZone> aisle{rectangle(8, -1, 12, 1, ZoneKind::kOneWay, 0.0)};
  EXPECT_NEAR(plan(map, {5, 0}, {15, 0}, {}, with_zones(aisle)).route.length_m, 10.0, 1e-9);
  EXPECT_NEAR(plan(map, {15, 0}, {5, 0}, {}, with_zones(aisle)).route.length_m, 50.0, 1e-9);
  const std::vector<DrawnZone> across{rectangle(8, -1, 12, 1, ZoneKind::kOneWay, 1.5708)};
  for (const auto& [from, to] : {std::pair(5.0, 15.0), std::pair(15.0, 5.0)}) {
    EXPECT_NEAR(plan(map, {from, 0}, {to, 0}, {}, with_zones(across)).route.length_m, 10.0, 1e-9);
  }
}

TEST(BranchRoutes, TakeAVirtualBranchAsTheLastResortAndSaySo) {
  GlobalMap map = square();
  add_map_branch(map, 14, 1, 4, {}, 0.0);
  map.branches.back().is_virtual = true;
  const PlanResult real = plan(map, {0, 0}, {20, 10});
  EXPECT_NEAR(real.route.length_m, 30.0, 1e-9);
  for (const RoutePart& part : real.route.parts) EXPECT_EQ(part.on, PlannedOn::kBranch);
  std::erase_if(map.branches, [](const auto& b) { return b.id == 11 || b.id == 13; });
  const PlanResult last = plan(map, {0, 5}, {20, 10});
  ASSERT_TRUE(last.found()) << last.reason;
  EXPECT_THAT(last.route.branch_ids, ElementsAre(12, 14));
  EXPECT_THAT(last.route.parts, ElementsAre(RoutePart{PlannedOn::kBranch, 12, 0},
                                            RoutePart{PlannedOn::kVirtualBranch, 14, 1}));
}

// Two corridors, one above the other, with a wall between, y = 0 to 2 and y = 2.1 to 4.1; a passage
// connects them on the right.
TEST(BranchRoutes, GetOnWhereNoWallIsBetween) {
  GlobalMap map;
  add_map_node(map, 1, 1.05, 1.05);
  add_map_node(map, 2, 18.05, 1.05);
  add_map_node(map, 3, 1.05, 3.15);
  add_map_node(map, 4, 18.05, 3.15);
  add_map_branch(map, 10, 1, 2);
  add_map_branch(map, 11, 3, 4);
  add_map_branch(map, 12, 2, 4);
  GridFrame frame;
  frame.columns = 190;
  frame.rows = 42;
  OccupancyGrid grid(frame, CellState::kFree);
  fill_box(grid, {0, 20}, {170, 20}, CellState::kOccupied);
  const FreeSpace space(grid);
  PlanScene scene;
  scene.space = &space;
  scene.prove_goal = true;
  // 1.0 m above the lower branch, 1.0 below the upper one, above the wall.
  const PlanResult result = plan(map, {5.05, 1.05}, {5.05, 2.45}, {}, scene);
  ASSERT_TRUE(result.found()) << result.reason;
  EXPECT_EQ(result.goal->branch_id, 11U);
  EXPECT_GT(result.route.length_m, 20.0);
  // A goal in the wall is impossible; beside it there is no room for the body.
  EXPECT_EQ(plan(map, {5.05, 1.05}, {5.05, 2.05}, {}, scene).status, PlanStatus::kGoalShut);
  EXPECT_EQ(plan(map, {5.05, 1.05}, {5.05, 1.95}, {}, scene).status, PlanStatus::kGoalShut);
}

TEST(BranchRoutes, OutvoteTheGridWhereTheClearanceOfABranchHasRoom) {
  GlobalMap map;
  add_map_node(map, 1, 1.05, 1.05);
  add_map_node(map, 2, 9.05, 1.05);
  add_map_branch(map, 10, 1, 2);
  GridFrame frame;
  frame.columns = 100;
  frame.rows = 21;
  OccupancyGrid grid(frame, CellState::kFree);
  grid.set({60, 10}, CellState::kOccupied);  // a person stood there during mapping
  const FreeSpace space(grid);
  PlanScene scene;
  scene.space = &space;
  scene.prove_goal = true;
  EXPECT_TRUE(plan(map, {2, 1}, {6.25, 1.25}, {}, scene).found());
  EXPECT_TRUE(plan(map, {2, 1}, {9, 1}, {}, scene).found());
  EXPECT_EQ(plan(map, {2, 1}, {6.05, 1.05}, {}, scene).status, PlanStatus::kGoalShut)
      << "the obstacle itself";
}

// Cost of a branch of the lattice below in either direction, by its rule.
struct BranchCost {
  double forth = 0.0;
  double back = 0.0;
};

// The Floyd-Warshall algorithm gives the cheapest paths on 200 lattices of 3 x 3 nodes, 4 m
// apart, where every second branch has a blockage, a slow or a one-way zone, or a bend.
TEST(BranchRoutes, AreTheCheapestOfAllOnRandomLattices) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::mt19937 random(5);
  std::size_t found = 0;
  std::size_t missing = 0;
  for (int round = 0; round < 200; ++round) {
    GlobalMap map;
    const auto at = [](int i) {
      const int row = i / 3;
      return Eigen::Vector2d(0.05 + 4.0 * (i % 3), 0.05 + 4.0 * row);
    };
    for (int i = 0; i < 9; ++i)
      add_map_node(map, static_cast<std::uint32_t>(i), at(i).x(), at(i).y());
    std::vector<DrawnZone> zones;
    std::vector<Eigen::Vector2d> filled_m;
    std::map<std::pair<int, int>, double> cost;
    const auto add = [&](int a, int b) {
      const Eigen::Vector2d middle_m = 0.5 * (at(a) + at(b));
      const bool upright = b - a == 3;
      BranchCost branch{4.0, 4.0};
      double clearance_m = 1.0;
      const auto zone = [&](ZoneKind kind, double value) {
        zones.push_back(rectangle(middle_m.x() - 0.55, middle_m.y() - 0.55, middle_m.x() + 0.45,
                                  middle_m.y() + 0.45, kind, value));
      };
      switch (random() % 8) {
        case 0:
          filled_m.push_back(middle_m);
          branch = {kNever, kNever};
          break;
        case 1:
          zone(ZoneKind::kSlow, 0.2);  // a metre of it takes three times as long
          branch = {6.0, 6.0};
          break;
        case 2:
          zone(ZoneKind::kOneWay, upright ? std::numbers::pi / 2 : 0.0);
          branch.back = kNever;
          break;
        case 3:
          zone(ZoneKind::kOneWay, upright ? -std::numbers::pi / 2 : std::numbers::pi);
          branch.forth = kNever;
          break;
        case 4:
          clearance_m = 0.2;
          branch = {kNever, kNever};
          break;
        default:
          break;
      }
      add_map_branch(map, static_cast<std::uint32_t>(map.branches.size()),
                     static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), {}, clearance_m);
      cost[{a, b}] = branch.forth;
      cost[{b, a}] = branch.back;
    };
    for (int i = 0; i < 9; ++i) {
      if (i % 3 < 2) add(i, i + 1);
      if (i < 6) add(i, i + 3);
    }
    std::vector least(9, std::vector<double>(9, kNever));
    for (std::size_t i = 0; i < 9; ++i) least[i][i] = 0.0;
    for (const auto& [ends, metres] : cost) {
      least[static_cast<std::size_t>(ends.first)][static_cast<std::size_t>(ends.second)] = metres;
    }
    for (std::size_t k = 0; k < 9; ++k) {
      for (std::size_t i = 0; i < 9; ++i) {
        for (std::size_t j = 0; j < 9; ++j) {
          least[i][j] = std::min(least[i][j], least[i][k] + least[k][j]);
        }
      }
    }
    PlanScene scene = with_zones(zones);
    scene.filled_m = filled_m;
    for (int a = 0; a < 9; ++a) {
      const int b = static_cast<int>(random() % 9);
      const double wanted = least[static_cast<std::size_t>(a)][static_cast<std::size_t>(b)];
      const PlanResult result = plan(map, at(a), at(b), {0.0, 0.3}, scene);
      if (result.status == PlanStatus::kStartShut || result.status == PlanStatus::kGoalShut) {
        continue;  // no branch of the node is wide enough
      }
      ASSERT_EQ(result.found(), std::isfinite(wanted))
          << round << ": " << a << " to " << b << " " << result.reason;
      result.found() ? ++found : ++missing;
      if (!result.found()) continue;
      // The first and last node are passed only when the route enters another of their branches.
      std::vector<int> nodes{a};
      for (const std::uint32_t node : result.route.node_ids) {
        if (static_cast<int>(node) != nodes.back()) nodes.push_back(static_cast<int>(node));
      }
      if (nodes.back() != b) nodes.push_back(b);
      double metres = 0.0;
      for (std::size_t i = 1; i < nodes.size(); ++i) metres += cost.at({nodes[i - 1], nodes[i]});
      EXPECT_NEAR(metres, wanted, 1e-9) << round << ": " << a << " to " << b;
    }
  }
  EXPECT_GT(found, 800U);
  EXPECT_GT(missing, 50U);
}

}  // namespace
}  // namespace topogeo::planning
