// Zones that forbid, slow down or direct traffic, against brute-force searches.
#include "topogeo/planning/driving_rules.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/local_detour.hpp"
#include "topogeo/planning/motion_primitives.hpp"

#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::HasSubstr;
using Polygon = std::vector<Eigen::Vector2d>;
constexpr double kHalfTurn_rad = std::numbers::pi;
constexpr InflationConfig kPoint{0.0, false};  // a robot without size

Polygon ruled_box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

/// Two corridors around a block, seven rows high.
const std::vector<std::string> kRing = {"#############",  //
                                        "#...........#",  //
                                        "#.#########.#",  //
                                        "#.#########.#",  //
                                        "#.#########.#",  //
                                        "#...........#",  //
                                        "#############"};

HybridMap map_with(const std::vector<DrawnZone>& zones, const std::vector<std::string>& floor,
                   const InflationConfig& inflation = kPoint) {
  FreeSpace space(grid_of_text(floor), inflation, zones);
  ZoneMap parts = zones_by_width(space);
  return {std::move(space), std::move(parts)};
}

/// Cost of a path by the definition of the rules; infinity for a forbidden one.
double ruled_cost(const GridFrame& frame, const std::vector<DrawnZone>& zones,
                  std::span<const Cell> cells) {
  const auto slowness = [&](const Cell& cell) {
    const Eigen::Vector2d at = frame.center_m(cell);
    double most = 1.0;
    bool lanes = false;
    bool on_lane = false;
    for (const DrawnZone& zone : zones) {
      const Polygon& p = zone.polygon_m;  // boxes
      const bool in =
          at.x() > p[0].x() && at.x() < p[2].x() && at.y() > p[0].y() && at.y() < p[2].y();
      if (in && zone.kind == ZoneKind::kSlow) most = std::max(most, 0.6 / zone.value);
      lanes = lanes || zone.kind == ZoneKind::kPreferred;
      on_lane = on_lane || (in && zone.kind == ZoneKind::kPreferred);
    }
    return lanes && !on_lane ? 1.5 * most : most;
  };
  const auto forbidden = [&](const Cell& cell, const Eigen::Vector2d& step) {
    const Eigen::Vector2d at = frame.center_m(cell);
    for (const DrawnZone& zone : zones) {
      const Polygon& p = zone.polygon_m;
      const bool in =
          at.x() > p[0].x() && at.x() < p[2].x() && at.y() > p[0].y() && at.y() < p[2].y();
      if (!in || zone.kind != ZoneKind::kOneWay) continue;
      const double turn =
          std::fabs(geometry::wrap_angle(std::atan2(step.y(), step.x()) - zone.value));
      if (turn > 2.0 * kHalfTurn_rad / 3.0 + 1e-6) return true;
    }
    return false;
  };
  double sum = 0.0;
  for (std::size_t i = 1; i < cells.size(); ++i) {
    const Eigen::Vector2d step = frame.center_m(cells[i]) - frame.center_m(cells[i - 1]);
    if (forbidden(cells[i - 1], step) || forbidden(cells[i], step)) {
      return std::numeric_limits<double>::infinity();
    }
    sum += step.norm() * 0.5 * (slowness(cells[i - 1]) + slowness(cells[i]));
  }
  return sum;
}

/// Least cost from one cell to another: relaxes every step until nothing gets cheaper.
double brute_force(const FreeSpace& space, const std::vector<DrawnZone>& zones, const Cell& from,
                   const Cell& to) {
  const GridFrame& frame = space.frame();
  std::vector<double> cost(frame.size(), std::numeric_limits<double>::infinity());
  cost[frame.index(from)] = 0.0;
  for (bool better = true; better;) {
    better = false;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      if (std::isinf(cost[i])) continue;
      const Cell a = frame.cell_at(i);
      for (std::int32_t y = -1; y <= 1; ++y) {
        for (std::int32_t x = -1; x <= 1; ++x) {
          const Cell b{a.column + x, a.row + y};
          if ((x == 0 && y == 0) || !space.passable(b)) continue;
          if (!space.passable(Cell{a.column + x, a.row}) ||
              !space.passable(Cell{a.column, a.row + y}))
            continue;
          const std::array<Cell, 2> step{a, b};
          const double sum = cost[i] + ruled_cost(frame, zones, step);
          if (sum < cost[frame.index(b)] - 1e-9) {
            cost[frame.index(b)] = sum;
            better = true;
          }
        }
      }
    }
  }
  return cost[frame.index(to)];
}

TEST(DrivingRules, NoRobotEntersANoGoZone) {
  // The robot keeps one cell of distance from it, as from walls.
  const std::vector<DrawnZone> zones = {{"wet", ruled_box(5, 5, 7, 6), ZoneKind::kNoGo, 0.0}};
  const HybridMap map = map_with(zones, kRing);
  const HybridRoute round = HybridPlanner(map).plan({2.5, 5.5}, Eigen::Vector2d(10.5, 5.5));
  ASSERT_EQ(round.status, RouteStatus::kFound) << round.reason;
  for (const Cell& cell : round.cells) EXPECT_NE(cell.row, 5 * (cell.column == 6)) << cell.column;
  EXPECT_GT(round.length_m, 12.0) << "below the block";
  const HybridRoute in = HybridPlanner(map).plan({2.5, 5.5}, Eigen::Vector2d(6.0, 5.5));
  EXPECT_EQ(in.status, RouteStatus::kGoalOccupied);
  EXPECT_THAT(in.reason, HasSubstr("is in the no-go zone 'wet'"));
  const FreeSpace wide(grid_of_text(std::vector<std::string>(9, ".........")), {1.0, false}, zones);
  EXPECT_FALSE(wide.passable(Cell{5, 5}));
  EXPECT_FALSE(wide.passable(Cell{5, 4}));
  EXPECT_TRUE(wide.passable(Cell{5, 3}));
  EXPECT_EQ(wide.clearance_m({5, 5}), std::numeric_limits<double>::infinity()) << "no wall";
}

TEST(DrivingRules, ASlowZoneIsGoneRoundWhereThatIsFaster) {
  const auto planned = [&](double speed) {
    const std::vector<DrawnZone> zones = {{"ramp", ruled_box(4, 5, 9, 6), ZoneKind::kSlow, speed}};
    return HybridPlanner(map_with(zones, kRing)).plan({1.5, 5.5}, Eigen::Vector2d(11.5, 5.5));
  };
  EXPECT_LT(planned(0.6).length_m, 11.0);
  EXPECT_LT(planned(0.4).length_m, 11.0) << "12.5 cells' worth of time against 18";
  EXPECT_GT(planned(0.2).length_m, 17.0) << "20 cells' worth";
}

TEST(DrivingRules, APreferredLaneIsTakenIfItIsNotMuchLonger) {
  const std::vector<DrawnZone> lanes = {
      {"left", ruled_box(1, 1, 2, 5), ZoneKind::kPreferred, 0.0},
      {"below", ruled_box(1, 1, 12, 2), ZoneKind::kPreferred, 0.0},
      {"right", ruled_box(11, 1, 12, 5), ZoneKind::kPreferred, 0.0}};
  const auto length_m = [&](const std::vector<DrawnZone>& zones, double y_m) {
    return HybridPlanner(map_with(zones, kRing))
        .plan({1.5, y_m}, Eigen::Vector2d(11.5, y_m))
        .length_m;
  };
  EXPECT_LT(length_m({}, 4.5), 13.0) << "above the block";
  EXPECT_GT(length_m(lanes, 4.5), 14.0) << "16 cells on lanes against 12 beside them";
  EXPECT_LT(length_m(lanes, 5.5), 11.0) << "18 cells on lanes against 10 beside them";
}

TEST(DrivingRules, AOneWayZoneIsDrivenInItsDirectionAlone) {
  const std::vector<DrawnZone> east = {{"aisle", ruled_box(4, 5, 9, 6), ZoneKind::kOneWay, 0.0}};
  const HybridMap map = map_with(east, kRing);
  const HybridPlanner planner(map);
  EXPECT_LT(planner.plan({1.5, 5.5}, Eigen::Vector2d(11.5, 5.5)).length_m, 11.0);
  EXPECT_GT(planner.plan({11.5, 5.5}, Eigen::Vector2d(1.5, 5.5)).length_m, 17.0);
  // Crossing is permitted; driving against it is not, even when the other path is blocked.
  const std::vector<DrawnZone> north = {
      {"aisle", ruled_box(4, 5, 9, 6), ZoneKind::kOneWay, kHalfTurn_rad / 2}};
  EXPECT_LT(
      HybridPlanner(map_with(north, kRing)).plan({11.5, 5.5}, Eigen::Vector2d(1.5, 5.5)).length_m,
      11.0);
  std::vector<std::string> line = kRing;
  line[5] = "#...##......#";
  const HybridRoute none =
      HybridPlanner(map_with(east, line)).plan({11.5, 5.5}, Eigen::Vector2d(1.5, 5.5));
  EXPECT_EQ(none.status, RouteStatus::kUnreachable);
  EXPECT_EQ(none.reason, "'aisle' is in the way");
}

// One corridor, five cells high.
const std::vector<std::string> kCorridor = {
    "##################", "#................#", "#................#", "#................#",
    "#................#", "#................#", "##################"};

TEST(DrivingRules, AReasonNamesTheDrawnItemsThatSeparateStartAndGoal) {
  const std::vector<DrawnZone> zones = {
      {"stairs", ruled_box(4, 1, 6, 6), ZoneKind::kNoGo, 0.0},
      {"far away", ruled_box(1, 1, 2, 2), ZoneKind::kNoGo, 0.0},
      {"aisle", ruled_box(10, 1, 12, 6), ZoneKind::kOneWay, kHalfTurn_rad}};
  const std::vector<DrawnLine> wall = {{LineKind::kWall, {{8.5, 0.5}, {8.5, 6.5}}, ""}};
  const InflationConfig inflation{0.0, false};
  const auto reason = [&](const std::vector<DrawnZone>& drawn, const std::vector<DrawnLine>& lines,
                          const Eigen::Vector2d& goal_m) {
    FreeSpace space(grid_of_text(kCorridor), inflation, drawn, lines);
    ZoneMap found = zones_by_width(space);
    const HybridMap map(std::move(space), std::move(found));
    const HybridRoute route = HybridPlanner(map).plan({2.5, 3.5}, goal_m);
    EXPECT_EQ(route.status, RouteStatus::kUnreachable);
    return route.reason;
  };
  EXPECT_EQ(reason(zones, {}, {15.5, 3.5}), "'stairs' and 'aisle' are in the way");
  EXPECT_EQ(reason({zones[0]}, wall, {15.5, 3.5}), "'stairs' and a drawn wall are in the way");
  EXPECT_EQ(reason({}, wall, {15.5, 3.5}), "a drawn wall is in the way");
  EXPECT_EQ(reason(zones, wall, {7.5, 3.5}), "'stairs' is in the way");
}

TEST(DrivingRules, TheNearestReachablePlaceIsReachedByTheRules) {
  // The goal lies beyond a one-way zone that leads towards the start.
  const std::vector<DrawnZone> zones = {
      {"aisle", ruled_box(8, 1, 10, 6), ZoneKind::kOneWay, kHalfTurn_rad}};
  FreeSpace space(grid_of_text(kCorridor), {0.0, false}, zones);
  ZoneMap found = zones_by_width(space);
  const HybridMap map(std::move(space), std::move(found));
  const HybridPlanner planner(map);
  const Eigen::Vector2d start_m(2.5, 3.5);
  const Eigen::Vector2d goal_m(15.5, 3.5);
  const HybridRoute none = planner.plan(start_m, goal_m);
  ASSERT_EQ(none.status, RouteStatus::kUnreachable) << none.reason;
  ASSERT_TRUE(none.nearest_reachable_m);
  EXPECT_LT(none.nearest_reachable_m->x(), 9.0) << "before the zone, or at its edge";
  EXPECT_TRUE(planner.plan(start_m, *none.nearest_reachable_m).found());
}

TEST(DrivingRules, RoutesAreTheCheapestOfAllThatAreAllowed) {
  support::Random random(7);
  const auto number = [&](double low, double high) { return random.uniform(low, high); };
  int ruled = 0;
  for (int floor = 0; floor < 60; ++floor) {
    OccupancyGrid grid(GridFrame{24, 18, 1.0, {}}, CellState::kFree);
    for (int i = 0; i < 60; ++i) {
      grid.set({static_cast<std::int32_t>(random.below(24)),
                static_cast<std::int32_t>(random.below(18))},
               CellState::kOccupied);
    }
    std::vector<DrawnZone> zones;
    for (int i = 0; i < 4; ++i) {
      const double x = number(0.0, 18.0);
      const double y = number(0.0, 12.0);
      DrawnZone zone{std::to_string(i), ruled_box(x, y, x + number(2, 9), y + number(2, 9)),
                     ZoneKind::kSlow, number(0.1, 0.5)};
      if (random.below(2) == 0) {
        zone.kind = ZoneKind::kOneWay;
        zone.value = number(-kHalfTurn_rad, kHalfTurn_rad);
      } else if (random.below(3) == 0) {
        zone.kind = ZoneKind::kPreferred;
        zone.value = 0.0;
      }
      zones.push_back(zone);
    }
    const Cell from{1, 1};
    const Cell to{22, 16};
    grid.set(from, CellState::kFree);
    grid.set(to, CellState::kFree);
    FreeSpace space(grid, kPoint, zones);
    const double least = brute_force(space, zones, from, to);
    ZoneMap parts = zones_by_width(space);
    const HybridMap map(std::move(space), std::move(parts));
    const HybridRoute route =
        HybridPlanner(map).plan(map.frame().center_m(from), map.frame().center_m(to));
    EXPECT_EQ(route.status == RouteStatus::kFound, std::isfinite(least)) << floor;
    if (route.status != RouteStatus::kFound) continue;
    EXPECT_NEAR(ruled_cost(map.frame(), zones, route.cells), least, 1e-4) << floor;
    ruled += least > brute_force(map.space(), {}, from, to) + 0.1 ? 1 : 0;
    // Straight lines follow the cells.
    for (std::size_t i = 1; i < route.points_m.size(); ++i) {
      const Eigen::Vector2d line = route.points_m[i] - route.points_m[i - 1];
      const Eigen::Vector2d middle = 0.5 * (route.points_m[i] + route.points_m[i - 1]);
      EXPECT_TRUE(map.space().rules().allows(map.frame().index(*map.frame().cell_of(middle)), line))
          << floor;
    }
  }
  EXPECT_GT(ruled, 10) << "the zones must matter";
}

TEST(DrivingRules, ADetourHeedsThem) {
  // A wall of boxes on the route, from the lower edge to the zone; the only gap is in the zone.
  const auto detour = [&](double heading_rad) {
    const std::vector<DrawnZone> zones = {
        {"aisle", ruled_box(3.0, 3.0, 6.0, 6.0), ZoneKind::kOneWay, heading_rad}};
    const FreeSpace space(grid_of_text(std::vector<std::string>(12, std::string(20, '.')), 0.5),
                          kPoint, zones);
    std::vector<Cell> route;
    for (std::int32_t column = 5; column < 19; ++column) route.push_back({column, 5});
    std::vector<Eigen::Vector2d> boxes_m;
    for (double y_m = 0.25; y_m < 2.9; y_m += 0.5) boxes_m.emplace_back(4.25, y_m);
    return plan_detour(space, route, {2.75, 2.75}, {9.25, 2.75}, boxes_m);
  };
  EXPECT_EQ(detour(0.0).status, DetourStatus::kFound);
  EXPECT_EQ(detour(kHalfTurn_rad).status, DetourStatus::kBlocked);
}

}  // namespace
}  // namespace topogeo::planning
