#include "topogeo/planning/hybrid_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivable.hpp"
#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::ThrowsMessage;

// Three rooms of five columns, with doors of one cell: row 2 from A to B, row 1 from B to C. Beyond
// C is a closet without a door.
HybridMap three_rooms() {
  InflationConfig inflation;
  inflation.forbidden_cells = 0.0;
  FreeSpace space(grid_of_text({
                      ".....#.....#.....#.",  // row 4
                      ".....#.....#.....#.",  //
                      "...........#.....#?",  //
                      ".....#...........#.",  //
                      ".....#.....#.....#.",  // row 0
                  }),
                  inflation);
  const auto room = [](const char* name, double x0, double x1) {
    return DrawnZone{name, {{x0, 0.0}, {x1, 0.0}, {x1, 5.0}, {x0, 5.0}}};
  };
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  ZoneMap zones =
      drawn_zones(space, std::vector{room("A", 0, 6), room("B", 6, 12), room("C", 12, 17)}, config);
  return {std::move(space), std::move(zones), {{"desk", {14.5, 4.5}}, {"wall", {5.5, 0.5}}}};
}

TEST(HybridMap, HasANodeInEachDoorAndAnEdgeThroughTheRoomBetween) {
  const HybridMap map = three_rooms();
  ASSERT_THAT(map.nodes(), SizeIs(2));
  EXPECT_EQ(map.nodes()[0].position_m, Eigen::Vector2d(6.0, 2.5));
  EXPECT_EQ(map.nodes()[1].position_m, Eigen::Vector2d(12.0, 1.5));
  ASSERT_THAT(map.edges(), SizeIs(1));
  EXPECT_EQ(map.edges()[0].route.front(), (Cell{6, 2}));
  EXPECT_EQ(map.edges()[0].route.back(), (Cell{11, 1}));
  // Four steps, one of them diagonal, and half a cell to the border on both sides.
  EXPECT_DOUBLE_EQ(map.edges()[0].cost_m, 4.0 + std::numbers::sqrt2 + 1.0);
}

// Two rooms separated by noise: the door between them is too narrow on the map. A robot in the door
// may have come from either room, whichever room's cells are nearer.
TEST(HybridPlanner, FromADoorThatTheMapShowsTooNarrowItLeavesToEitherSide) {
  InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  FreeSpace space(grid_of_text(
                      {
                          "........#........",
                          "........#........",
                          ".................",
                          "........#........",
                          "........#........",
                      },
                      0.25),
                  inflation);
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  ZoneMap zones = drawn_zones(space, {}, config);
  ASSERT_THAT(zones.zones, SizeIs(2));
  const HybridMap map(std::move(space), std::move(zones));
  const HybridPlanner planner(map);
  const double y_m = 2.5 * 0.25;
  for (const double from_m : {8.4 * 0.25, 8.6 * 0.25}) {
    for (const double to_m : {2.5 * 0.25, 14.5 * 0.25}) {
      const HybridRoute route = planner.plan({from_m, y_m}, Eigen::Vector2d(to_m, y_m));
      EXPECT_TRUE(route.found()) << from_m << " to " << to_m << ": " << route.reason;
    }
  }
  // There is no path from a room into the other one.
  const HybridRoute route = planner.plan({2.5 * 0.25, y_m}, Eigen::Vector2d(14.5 * 0.25, y_m));
  EXPECT_EQ(route.status, RouteStatus::kUnreachable);
}

TEST(HybridMap, HasItsNodeInTheMiddleOfAWideBorder) {
  InflationConfig inflation;
  inflation.forbidden_cells = 0.0;
  FreeSpace space(grid_of_text(std::vector<std::string>(7, "......")), inflation);
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  const std::vector<DrawnZone> left{{"left", {{0, 0}, {3, 0}, {3, 7}, {0, 7}}}};
  ZoneMap zones = drawn_zones(space, left, config);
  const HybridMap map(std::move(space), std::move(zones));
  ASSERT_THAT(map.nodes(), SizeIs(1));
  EXPECT_EQ(map.nodes()[0].position_m, Eigen::Vector2d(3.0, 3.5));
  EXPECT_THAT(map.nodes()[0].border[0], SizeIs(7));
}

TEST(HybridMap, RefusesZonesOfAnotherGridAndNamesTwice) {
  const HybridMap good = three_rooms();
  ZoneMap zones = good.zones();
  zones.zone_of_cell[0] = kNoZone;
  EXPECT_THAT([&] { HybridMap(good.space(), zones); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("cell 0")));
  EXPECT_THAT(
      [&] {
        HybridMap(good.space(), good.zones(), {{"a", {0, 0}}, {"a", {1, 1}}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("'a'")));
}

TEST(HybridPlanner, StaysOnTheGridWithinAZone) {
  const HybridMap map = three_rooms();
  const HybridRoute route = HybridPlanner(map).plan({0.5, 0.5}, Eigen::Vector2d(4.5, 3.5));
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_EQ(route.kind, RouteKind::kSameZone);
  EXPECT_DOUBLE_EQ(route.cost_m, 1.0 + 3.0 * std::numbers::sqrt2);
  EXPECT_DOUBLE_EQ(route.length_m, 5.0);
  EXPECT_THAT(route.points_m, ElementsAre(Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(4.5, 3.5)));
  EXPECT_THAT(route.nodes, IsEmpty());
  EXPECT_THAT(route.zones, SizeIs(1));
}

TEST(HybridPlanner, GoesThroughTheNodeBetweenAdjacentZones) {
  const HybridMap map = three_rooms();
  const HybridRoute route = HybridPlanner(map).plan({0.5, 2.5}, Eigen::Vector2d(10.5, 2.5));
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_EQ(route.kind, RouteKind::kAdjacentZones);
  EXPECT_DOUBLE_EQ(route.cost_m, 10.0);
  EXPECT_THAT(route.nodes, ElementsAre(0));
  EXPECT_THAT(route.edges, IsEmpty());
  EXPECT_THAT(route.zones, SizeIs(2));
  EXPECT_DOUBLE_EQ(route.min_clearance_m, 1.0);
}

TEST(HybridPlanner, FollowsTheGraphBetweenDistantZones) {
  const HybridMap map = three_rooms();
  const HybridRoute route = HybridPlanner(map).plan({2.5, 2.5}, std::string("desk"));
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_EQ(route.kind, RouteKind::kDistantZones);
  EXPECT_THAT(route.nodes, ElementsAre(0, 1));
  EXPECT_THAT(route.edges, ElementsAre(0));
  EXPECT_DOUBLE_EQ(route.cost_m, plan_on_grid(map.space(), {2.5, 2.5}, {14.5, 4.5}).cost_m);
  EXPECT_EQ(route.cells.front(), (Cell{2, 2}));
  EXPECT_EQ(route.cells.back(), (Cell{14, 4}));
}

TEST(HybridPlanner, GoesToANode) {
  const HybridMap map = three_rooms();
  const HybridRoute route = HybridPlanner(map).plan({2.5, 2.5}, NodeNumber{1});
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_EQ(route.cells.back(), map.nodes()[1].cells[0]);
}

TEST(HybridPlanner, SaysWhatIsWrongWithAGoalAndWhatIsNear) {
  const HybridMap map = three_rooms();
  const HybridPlanner planner(map);
  const Eigen::Vector2d start_m(2.5, 2.5);
  const auto status = [&](const Target& to) { return planner.plan(start_m, to).status; };
  EXPECT_EQ(status(std::string("kitchen")), RouteStatus::kUnknownPlace);
  EXPECT_EQ(status(NodeNumber{2}), RouteStatus::kUnknownNode);
  EXPECT_EQ(status(std::string("wall")), RouteStatus::kGoalOccupied);
  EXPECT_EQ(status(Eigen::Vector2d(-3.0, 2.5)), RouteStatus::kGoalOutside);
  EXPECT_EQ(status(Eigen::Vector2d(18.5, 2.5)), RouteStatus::kGoalOutside);
  EXPECT_EQ(status(Eigen::Vector2d(18.5, 4.5)), RouteStatus::kUnreachable);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(status(Eigen::Vector2d(nan, 4.5)), RouteStatus::kInvalidPoint);
  EXPECT_EQ(planner.plan(start_m, Eigen::Vector2d(18.5, 4.5)).nearest_reachable_m,
            Eigen::Vector2d(16.5, 4.5));
  EXPECT_EQ(planner.plan(start_m, std::string("wall")).nearest_reachable_m,
            Eigen::Vector2d(4.5, 0.5));
  EXPECT_THAT(planner.plan(start_m, std::string("kitchen")).reason, HasSubstr("'kitchen'"));
}

TEST(HybridPlanner, SaysWhatIsWrongWithAStart) {
  const HybridMap map = three_rooms();
  const HybridPlanner planner(map);
  const Eigen::Vector2d goal_m(2.5, 2.5);
  EXPECT_EQ(planner.plan({5.5, 0.5}, goal_m).status, RouteStatus::kStartOccupied);
  EXPECT_EQ(planner.plan({50.0, 0.5}, goal_m).status, RouteStatus::kStartOutside);
  EXPECT_EQ(planner.plan({18.5, 2.5}, goal_m).status, RouteStatus::kStartOutside);
}

TEST(HybridPlanner, GetsARobotOutOfAForbiddenCell) {
  FreeSpace space(grid_of_text(std::vector<std::string>(1, "#................"), 0.1));
  ZoneConfig config;
  config.min_area_m2 = 0.0;
  ZoneMap zones = zones_by_width(space, config);
  const HybridMap map(std::move(space), std::move(zones));
  const HybridRoute route = HybridPlanner(map).plan({0.25, 0.05}, Eigen::Vector2d(1.55, 0.05));
  ASSERT_TRUE(route.found()) << route.reason;
  EXPECT_EQ(route.cells.front(), (Cell{4, 0}));
  EXPECT_EQ(route.points_m.front(), Eigen::Vector2d(0.25, 0.05));
  EXPECT_EQ(HybridPlanner(map).plan({1.0, 0.05}, Eigen::Vector2d(0.25, 0.05)).status,
            RouteStatus::kGoalOccupied);
}

// A ring of four rooms: when a door shuts, the route takes the other direction.
TEST(HybridPlanner, AvoidsWhatIsClosedNow) {
  BlockPlan plan;
  plan.columns = 2;
  plan.rows = 2;
  plan.furniture = 0;
  std::uint64_t seed = 0;
  BlockFloor floor = block_floor(plan, seed);
  FreeSpace space(floor.grid);
  HybridMap map(space, drawn_zones(space, floor.rooms));
  while (map.nodes().size() < 4) {
    floor = block_floor(plan, ++seed);
    space = FreeSpace(floor.grid);
    map = HybridMap(space, drawn_zones(space, floor.rooms));
  }
  const HybridPlanner planner(map);
  const Eigen::Vector2d from_m(2.5, 2.0);
  const Eigen::Vector2d to_m(7.5, 2.0);
  const HybridRoute open = planner.plan(from_m, to_m);
  ASSERT_TRUE(open.found());
  ASSERT_THAT(open.nodes, SizeIs(1));
  const HybridRoute round = planner.plan(from_m, to_m, {{open.nodes[0]}, {}});
  ASSERT_TRUE(round.found());
  EXPECT_THAT(round.nodes, SizeIs(3));
  EXPECT_GT(round.cost_m, open.cost_m);
  const HybridRoute other = planner.plan(from_m, to_m, {{open.nodes[0]}, {round.edges[0]}});
  EXPECT_EQ(other.status, RouteStatus::kUnreachable);
  const HybridRoute shut = planner.plan(from_m, to_m, {{open.nodes[0], round.nodes[0]}, {}});
  EXPECT_EQ(shut.status, RouteStatus::kUnreachable);
  EXPECT_THAT(shut.reason, HasSubstr("closed now"));
  ASSERT_TRUE(shut.nearest_reachable_m);
  EXPECT_EQ(map.zone_of(map.frame().cell_of(*shut.nearest_reachable_m).value()),
            map.zone_of(map.frame().cell_of(from_m).value()));
  EXPECT_THROW((void)planner.plan(from_m, to_m, {{99}, {}}), std::invalid_argument);
  EXPECT_THROW((void)planner.plan(from_m, to_m, {{}, {99}}), std::invalid_argument);
}

// A floor, pairs of points on it and the shortest paths between them.
struct PlannedFloor {
  struct Trip {
    Eigen::Vector2d from_m;
    Eigen::Vector2d to_m;
    HybridRoute shortest;
  };
  std::vector<DrawnZone> rooms;
  FreeSpace space;
  std::vector<Trip> trips;
};

PlannedFloor planned_floor(std::uint64_t seed) {
  BlockPlan plan;
  plan.columns = 6;
  plan.rows = 5;
  BlockFloor floor = block_floor(plan, 100 + seed);
  PlannedFloor planned{std::move(floor.rooms), FreeSpace(std::move(floor.grid)), {}};
  support::Random random(seed);
  for (int k = 0; k < 30; ++k) {
    const Eigen::Vector2d from_m = random_free_point_m(planned.space, random);
    const Eigen::Vector2d to_m = random_free_point_m(planned.space, random);
    planned.trips.push_back({from_m, to_m, plan_on_grid(planned.space, from_m, to_m)});
  }
  return planned;
}

// Searches of whole grids take longest; their results are the same for every planner.
const std::vector<PlannedFloor>& planned_floors() {
  static const std::vector<PlannedFloor> floors = [] {
    std::vector<PlannedFloor> made;
    for (std::uint64_t seed = 0; seed < 12; ++seed) made.push_back(planned_floor(seed));
    return made;
  }();
  return floors;
}

// Relative excess of the routes over the shortest paths, over floors and pairs of points.
std::vector<double> detours(bool drawn, const HybridPlannerConfig& config) {
  std::vector<double> longer;
  for (const auto& [rooms, space, trips] : planned_floors()) {
    const HybridMap map(space, drawn ? drawn_zones(space, rooms) : zones_by_width(space));
    const HybridPlanner planner(map, config);
    for (const auto& [from_m, to_m, shortest] : trips) {
      const HybridRoute route = planner.plan(from_m, to_m);
      EXPECT_EQ(route.found(), shortest.found());
      if (!route.found()) continue;
      expect_drivable(space, route);
      EXPECT_GE(route.cost_m, shortest.cost_m - 1e-9);
      if (shortest.cost_m > 0.0) longer.push_back(route.cost_m / shortest.cost_m - 1.0);
    }
  }
  std::sort(longer.begin(), longer.end());
  return longer;
}

void record(const std::vector<double>& longer) {
  ASSERT_GT(longer.size(), 300U);
  const auto percent = [&](double share) {
    const auto last = static_cast<double>(longer.size() - 1);
    return std::to_string(100.0 * longer[static_cast<std::size_t>(share * last)]);
  };
  testing::Test::RecordProperty("median_percent", percent(0.5));
  testing::Test::RecordProperty("p90_percent", percent(0.9));
  testing::Test::RecordProperty("p99_percent", percent(0.99));
  testing::Test::RecordProperty("most_percent", percent(1.0));
}

TEST(HybridPlanner, IsAtMostFivePercentLongerThanTheShortestPath) {
  for (const bool drawn : {true, false}) {
    const std::vector<double> longer = detours(drawn, {});
    record(longer);
    EXPECT_LE(longer.back(), 0.05) << (drawn ? "drawn" : "found") << " zones";
  }
}

// MACONDO's planner alone, through the middles of the borders.
TEST(HybridPlanner, IsNearlyAsGoodWithoutPlanningAgain) {
  HybridPlannerConfig config;
  config.piece_m = 0.0;
  config.exact_window_cells = 0.0;
  const std::vector<double> longer = detours(true, config);
  record(longer);
  EXPECT_LE(longer[longer.size() / 2], 0.05);
  EXPECT_GT(longer.back(), 0.05) << "planning again would be needless";
}

// Doors shut at random: a route never crosses a shut one, and is unreachable exactly when the shut
// doors, as walls, leave no path.
TEST(HybridPlanner, IsRightAboutDoorsThatShutAtRandom) {
  int unreachable = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const BlockFloor floor = block_floor({}, 200 + seed);
    const FreeSpace space(floor.grid);
    const HybridMap map(space, drawn_zones(space, floor.rooms));
    const HybridPlanner planner(map);
    support::Random random(seed);
    for (int k = 0; k < 12; ++k) {
      Closures closed;
      SearchWindow walls(space, whole(space.frame()));
      for (const BorderNode& node : map.nodes()) {
        if (random.below(3) != 0) continue;
        closed.nodes.push_back(node.id);
        for (const Cell& cell : node.border[0]) walls.close(cell);
      }
      const Eigen::Vector2d from_m = random_free_point_m(space, random);
      const Eigen::Vector2d to_m = random_free_point_m(space, random);
      const Cell from = space.frame().cell_of(from_m).value();
      const Cell to = space.frame().cell_of(to_m).value();
      if (!walls.open(from) || !walls.open(to)) continue;
      const HybridRoute route = planner.plan(from_m, to_m, closed);
      ASSERT_EQ(route.found(), shortest_path(walls, from, to).has_value());
      if (!route.found()) ++unreachable;
      for (std::size_t i = 1; i < route.cells.size(); ++i) {
        for (const std::uint32_t id : closed.nodes) {
          const auto on = [&](std::size_t side, const Cell& cell) {
            const auto& border = map.nodes()[id].border[side];
            return std::find(border.begin(), border.end(), cell) != border.end();
          };
          const Cell& a = route.cells[i - 1];
          const Cell& b = route.cells[i];
          ASSERT_FALSE((on(0, a) && on(1, b)) || (on(1, a) && on(0, b)));
        }
      }
    }
  }
  EXPECT_GT(unreachable, 5);
}

TEST(HybridPlanner, RefusesAConfigurationOutOfRange) {
  const HybridMap map = three_rooms();
  HybridPlannerConfig config;
  config.start_snap_m = -0.1;
  EXPECT_THAT([&] { HybridPlanner(map, config); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("key 'hybrid_planner.start_snap_m' = '-0.1'")));
}

TEST(RouteStatus, HasAWordForEach) {
  EXPECT_EQ(describe(RouteStatus::kFound), "found");
  EXPECT_EQ(describe(RouteStatus::kUnreachable), "unreachable");
  EXPECT_EQ(describe(static_cast<RouteStatus>(200)), "unknown status");
}

}  // namespace
}  // namespace topogeo::planning
