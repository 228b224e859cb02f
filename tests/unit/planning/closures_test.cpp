// Routes that avoid present obstructions.
#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"

#include "drivable.hpp"
#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

// Rooms 0 and 1 below, 2 and 3 above, each with a door to both of its neighbours.
struct Ring {
  FreeSpace space;
  HybridMap map;

  [[nodiscard]] ZoneId zone_at(double x_m, double y_m) const {
    return map.zone_of(map.frame().cell_of({x_m, y_m}).value());
  }
  // Cells of the walls that contain the door of a node.
  [[nodiscard]] std::vector<Cell> door(std::uint32_t node) const {
    std::vector<Cell> cells = map.nodes()[node].border[0];
    const auto& other = map.nodes()[node].border[1];
    cells.insert(cells.end(), other.begin(), other.end());
    return cells;
  }
};

Ring ring_with_door() {
  BlockPlan plan;
  plan.columns = 2;
  plan.rows = 2;
  plan.furniture = 0;
  for (std::uint64_t seed = 0;; ++seed) {
    const BlockFloor floor = block_floor(plan, seed);
    const FreeSpace space(floor.grid);
    HybridMap map(space, drawn_zones(space, floor.rooms));
    if (map.nodes().size() == 4) return {space, std::move(map)};
  }
}

const Eigen::Vector2d kRoom0_m(2.5, 2.0);
const Eigen::Vector2d kRoom1_m(7.5, 2.0);
const Eigen::Vector2d kRoom3_m(7.5, 6.0);

// The grid with more cells occupied.
FreeSpace with_filled(const FreeSpace& space, const std::vector<Cell>& cells) {
  OccupancyGrid grid = space.grid();
  for (const Cell& cell : cells) {
    if (grid.frame().contains(cell)) grid.set(cell, CellState::kOccupied);
  }
  return FreeSpace(grid, space.inflation());
}

// The open cells that are connected to one across their sides.
std::vector<bool> reached_from(const FreeSpace& space, const Cell& from) {
  std::vector<bool> reached(space.frame().size(), false);
  std::vector<Cell> open{from};
  reached[space.frame().index(from)] = true;
  while (!open.empty()) {
    const Cell at = open.back();
    open.pop_back();
    for (const Cell& next : {Cell{at.column + 1, at.row}, Cell{at.column - 1, at.row},
                             Cell{at.column, at.row + 1}, Cell{at.column, at.row - 1}}) {
      if (!space.passable(next) || reached[space.frame().index(next)]) continue;
      reached[space.frame().index(next)] = true;
      open.push_back(next);
    }
  }
  return reached;
}

// The planner of the publication, which does not plan again on the grid.
HybridPlannerConfig as_the_source() {
  HybridPlannerConfig config;
  config.exact_window_cells = 0.0;
  config.piece_m = 0.0;
  return config;
}

TEST(Closures, OneShutDoorOfARingSendsTheRobotRoundTheOtherSide) {
  const Ring floor = ring_with_door();
  const HybridPlanner planner(floor.map);
  const HybridRoute open = planner.plan(kRoom0_m, kRoom1_m);
  ASSERT_THAT(open.nodes, SizeIs(1));
  Closures shut;
  shut.cells = floor.door(open.nodes[0]);
  const HybridRoute round = planner.plan(kRoom0_m, kRoom1_m, shut);
  ASSERT_TRUE(round.found()) << round.reason;
  EXPECT_THAT(round.nodes, SizeIs(3));
  EXPECT_THAT(round.edges, SizeIs(2));
  EXPECT_THAT(round.nodes, Not(Contains(open.nodes[0])));
  EXPECT_THAT(round.zones, SizeIs(4));
  expect_drivable(with_filled(floor.space, shut.cells), round);
}

TEST(Closures, AllDoorsShutLeaveTheRobotInItsRoom) {
  const Ring floor = ring_with_door();
  const HybridPlanner planner(floor.map);
  Closures shut;
  for (const BorderNode& node : floor.map.nodes()) {
    const auto door = floor.door(node.id);
    shut.cells.insert(shut.cells.end(), door.begin(), door.end());
  }
  const HybridRoute none = planner.plan(kRoom0_m, kRoom3_m, shut);
  EXPECT_EQ(none.status, RouteStatus::kUnreachable);
  EXPECT_THAT(none.reason, HasSubstr("closed now"));
  ASSERT_TRUE(none.nearest_reachable_m);
  EXPECT_EQ(floor.zone_at(none.nearest_reachable_m->x(), none.nearest_reachable_m->y()),
            floor.zone_at(kRoom0_m.x(), kRoom0_m.y()));
  EXPECT_TRUE(planner.plan(kRoom0_m, *none.nearest_reachable_m, shut).found());
}

// When the whole route is planned again on the grid, the closed edge would be shorter.
TEST(Closures, PlanningAgainDoesNotLeadBackThroughAClosedEdge) {
  const Ring floor = ring_with_door();
  const HybridPlanner planner(floor.map);
  const HybridRoute open = planner.plan(kRoom0_m, kRoom3_m);
  ASSERT_THAT(open.edges, SizeIs(1));
  const HybridRoute other = planner.plan(kRoom0_m, kRoom3_m, {{}, open.edges, {}});
  ASSERT_TRUE(other.found()) << other.reason;
  EXPECT_GT(other.cost_m, open.cost_m);
  EXPECT_THAT(other.edges, SizeIs(1));
  EXPECT_NE(other.edges, open.edges);
  EXPECT_THAT(other.zones, SizeIs(3));
  EXPECT_NE(other.zones[1], open.zones[1]);
}

// Three zones without walls between them: A to the left, B to the right, C above both.
TEST(Closures, StraightLinesDoNotCutThroughAClosedBorder) {
  InflationConfig inflation;
  inflation.forbidden_cells = 0.0;
  const FreeSpace space(grid_of_text(std::vector<std::string>(12, std::string(20, '.'))),
                        inflation);
  const std::vector<DrawnZone> drawn{{"A", {{0, 0}, {10, 0}, {10, 8}, {0, 8}}},
                                     {"B", {{10, 0}, {20, 0}, {20, 8}, {10, 8}}},
                                     {"C", {{0, 8}, {20, 8}, {20, 12}, {0, 12}}}};
  const HybridMap map(space, drawn_zones(space, drawn));
  const auto between_a_and_b =
      std::find_if(map.nodes().begin(), map.nodes().end(), [](const BorderNode& node) {
        return node.zones == std::array<ZoneId, 2>{0, 1};
      });
  ASSERT_NE(between_a_and_b, map.nodes().end());
  const HybridRoute route =
      HybridPlanner(map).plan({2.5, 4.5}, Eigen::Vector2d(17.5, 4.5), {{between_a_and_b->id}, {}});
  ASSERT_TRUE(route.found()) << route.reason;
  ZoneId before = 0;
  for (std::size_t i = 1; i < route.points_m.size(); ++i) {
    for (int k = 0; k <= 1000; ++k) {
      const Eigen::Vector2d at_m =
          route.points_m[i - 1] + k / 1000.0 * (route.points_m[i] - route.points_m[i - 1]);
      const ZoneId zone = map.zone_of(map.frame().cell_of(at_m).value());
      ASSERT_FALSE(before == 0 && zone == 1) << at_m.transpose();
      before = zone;
    }
  }
}

// A border of 4 m with an obstacle in its middle.
TEST(Closures, AWideBorderIsCrossedWhereItIsOpen) {
  InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  const FreeSpace space(grid_of_text(std::vector<std::string>(40, std::string(60, '.')), 0.1),
                        inflation);
  const std::vector<DrawnZone> drawn{{"left", {{0, 0}, {3, 0}, {3, 4}, {0, 4}}}};
  const HybridMap map(space, drawn_zones(space, drawn));
  ASSERT_THAT(map.nodes(), SizeIs(1));
  Closures closed;
  for (std::int32_t row = 3; row < 40; ++row) closed.cells.push_back({29, row});
  for (const HybridPlannerConfig& config : {HybridPlannerConfig{}, as_the_source()}) {
    const HybridPlanner planner(map, config);
    const HybridRoute route = planner.plan({0.55, 3.55}, Eigen::Vector2d(5.55, 3.55), closed);
    ASSERT_TRUE(route.found()) << route.reason;
    expect_drivable(with_filled(space, closed.cells), route);
    EXPECT_THAT(route.nodes, ElementsAre(0));
    EXPECT_NEAR(route.min_clearance_m, 0.2, 1e-9);
  }
  closed.cells.push_back({29, 0});
  EXPECT_EQ(HybridPlanner(map).plan({0.55, 3.55}, Eigen::Vector2d(5.55, 3.55), closed).status,
            RouteStatus::kUnreachable);
}

// An obstacle across a whole room with two doors: the route between its parts goes round the ring.
TEST(Closures, AZoneThatIsCutInTwoIsLeftAndEnteredAgain) {
  const Ring floor = ring_with_door();
  const HybridPlanner planner(floor.map);
  // Room 0 is 5 x 4 m; its doors are on the right and at the top.
  const auto nodes = floor.map.nodes_of(floor.zone_at(kRoom0_m.x(), kRoom0_m.y()));
  ASSERT_THAT(nodes, SizeIs(2));
  Closures closed;
  for (std::int32_t k = 0; k < 60; ++k) {
    closed.cells.push_back({k, 39 - k});  // from the upper left corner down to the right
    closed.cells.push_back({k + 1, 39 - k});
  }
  const Eigen::Vector2d low_m(0.75, 0.75);
  const Eigen::Vector2d high_m(4.3, 3.3);
  const FreeSpace filled = with_filled(floor.space, closed.cells);
  const HybridRoute route = planner.plan(low_m, high_m, closed);
  const HybridRoute best = plan_on_grid(filled, low_m, high_m);
  ASSERT_EQ(route.status, best.status) << route.reason;
  if (route.found()) expect_drivable(filled, route);
}

TEST(Closures, ARobotBeforeAnObstacleStartsOnItsSideOfIt) {
  const FreeSpace space(grid_of_text(std::vector<std::string>(30, std::string(60, '.')), 0.1));
  const HybridMap map(space, zones_by_width(space));
  const HybridPlanner planner(map);
  Closures closed;  // a wall with a passage at its upper end
  for (std::int32_t row = 0; row < 20; ++row) closed.cells.push_back({30, row});
  const Eigen::Vector2d goal_m(5.05, 1.05);
  const HybridRoute left = planner.plan({2.85, 1.05}, goal_m, closed);
  ASSERT_TRUE(left.found()) << left.reason;
  EXPECT_EQ(left.cells.front(), (Cell{26, 10}));
  EXPECT_EQ(left.points_m.front(), Eigen::Vector2d(2.85, 1.05));
  EXPECT_TRUE(std::any_of(left.cells.begin(), left.cells.end(),
                          [](const Cell& cell) { return cell.row >= 23; }));
  const HybridRoute right = planner.plan({3.25, 1.05}, goal_m, closed);
  ASSERT_TRUE(right.found()) << right.reason;
  EXPECT_EQ(right.cells.front(), (Cell{34, 10}));
  const HybridRoute inside = planner.plan({3.05, 1.05}, goal_m, closed);
  EXPECT_EQ(inside.status, RouteStatus::kStartOccupied);
  EXPECT_THAT(inside.reason, HasSubstr("not on the map"));
}

TEST(Closures, AGoalThatSomethingFillsIsOccupiedAndHasAPlaceNearIt) {
  const Ring floor = ring_with_door();
  Closures closed;
  closed.cells = {floor.map.frame().cell_of(kRoom1_m).value()};
  const HybridPlanner planner(floor.map);
  const HybridRoute in = planner.plan(kRoom0_m, kRoom1_m, closed);
  EXPECT_EQ(in.status, RouteStatus::kGoalOccupied);
  EXPECT_THAT(in.reason, HasSubstr("in an obstacle that is not on the map"));
  ASSERT_TRUE(in.nearest_reachable_m);
  EXPECT_NEAR((*in.nearest_reachable_m - kRoom1_m).norm(), 0.35, 0.11);
  const HybridRoute beside = planner.plan(kRoom0_m, Eigen::Vector2d(7.7, 2.0), closed);
  EXPECT_EQ(beside.status, RouteStatus::kGoalOccupied);
  EXPECT_THAT(beside.reason, HasSubstr("0.20 m from an obstacle that is not on the map"));
}

TEST(Closures, CellsOnWallsAndBeyondTheGridChangeNothing) {
  const Ring floor = ring_with_door();
  const HybridPlanner planner(floor.map);
  Closures closed;
  closed.cells = {{0, 0}, {-50, 3}, {5000, 5000}};
  const HybridRoute open = planner.plan(kRoom0_m, kRoom3_m);
  const HybridRoute same = planner.plan(kRoom0_m, kRoom3_m, closed);
  EXPECT_EQ(same.cells, open.cells);
  EXPECT_EQ(same.nodes, open.nodes);
  EXPECT_EQ(same.points_m, open.points_m);
}

// Boxes and walls of random size, half of them in doors.
std::vector<Cell> random_things(const HybridMap& map, support::Random& random) {
  std::vector<Cell> cells;
  const std::uint64_t things = 1 + random.below(40);
  for (std::uint64_t k = 0; k < things; ++k) {
    const bool in_door = random.below(2) == 0;
    const Cell at = in_door ? map.nodes()[random.below(map.nodes().size())].cells[0]
                            : map.frame().cell_at(random.below(map.frame().size()));
    const auto width = static_cast<std::int32_t>(random.below(random.below(4) == 0 ? 40 : 6));
    const auto height = static_cast<std::int32_t>(random.below(random.below(4) == 0 ? 40 : 6));
    for (std::int32_t y = 0; y <= height; ++y) {
      for (std::int32_t x = 0; x <= width; ++x) cells.push_back({at.column + x, at.row + y});
    }
  }
  return cells;
}

void expect_nearest(const FreeSpace& filled, const Eigen::Vector2d& from_m,
                    const Eigen::Vector2d& to_m, const HybridRoute& route) {
  ASSERT_TRUE(route.nearest_reachable_m);
  const HybridRoute there = plan_on_grid(filled, from_m, *route.nearest_reachable_m);
  ASSERT_TRUE(there.found());
  const std::vector<bool> reached = reached_from(filled, there.cells.front());
  double least_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < reached.size(); ++i) {
    if (!reached[i]) continue;
    const Eigen::Vector2d middle_m = filled.frame().center_m(filled.frame().cell_at(i));
    least_m = std::min(least_m, (middle_m - to_m).norm());
  }
  EXPECT_DOUBLE_EQ((*route.nearest_reachable_m - to_m).norm(), least_m);
}

double least_clearance_m(const FreeSpace& space, const HybridRoute& route) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Cell& cell : route.cells) least_m = std::min(least_m, space.clearance_m(cell));
  return least_m;
}

// The oracle searches the whole grid with the obstructions as occupied cells.
TEST(Closures, PlansAsTheGridWouldWithTheCellsOccupied) {
  int found = 0;
  int unreachable = 0;
  double longest = 0.0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    BlockPlan plan;
    plan.columns = 7;
    plan.rows = 6;
    const BlockFloor floor = block_floor(plan, 300 + seed);
    const FreeSpace space(floor.grid);
    const bool drawn = seed % 2 == 0;
    const HybridMap map(space, drawn ? drawn_zones(space, floor.rooms) : zones_by_width(space));
    const HybridPlanner planner(map);
    const HybridPlanner through_middles(map, as_the_source());
    support::Random random(seed);
    for (int k = 0; k < 25; ++k) {
      Closures closed;
      closed.cells = random_things(map, random);
      const FreeSpace filled = with_filled(space, closed.cells);
      const Eigen::Vector2d from_m = random_free_point_m(space, random);
      const Eigen::Vector2d to_m = random_free_point_m(space, random);
      const HybridRoute route = planner.plan(from_m, to_m, closed);
      const HybridRoute best = plan_on_grid(filled, from_m, to_m);
      ASSERT_EQ(route.status, best.status) << seed << " " << k << ": " << route.reason;
      EXPECT_EQ(through_middles.plan(from_m, to_m, closed).status, best.status);
      if (route.status == RouteStatus::kUnreachable) {
        ++unreachable;
        expect_nearest(filled, from_m, to_m, route);
      }
      if (!route.found()) continue;
      ++found;
      expect_drivable(filled, route);
      EXPECT_DOUBLE_EQ(route.min_clearance_m, least_clearance_m(filled, route));
      EXPECT_GE(route.cost_m, best.cost_m - 1e-9);
      if (best.cost_m > 0.0) longest = std::max(longest, route.cost_m / best.cost_m - 1.0);
    }
  }
  EXPECT_GT(found, 150);
  EXPECT_GT(unreachable, 20);
  EXPECT_LE(longest, 0.05);
  testing::Test::RecordProperty("most_percent", std::to_string(100.0 * longest));
}

}  // namespace
}  // namespace topogeo::planning
