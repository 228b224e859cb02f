// Drawn walls, openings and doors, against their definition cell by cell.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/route_planner.hpp"
#include "topogeo/planning/zone_outlines.hpp"

#include "branch_maps.hpp"
#include "drivable.hpp"
#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::HasSubstr;
using Points = std::vector<Eigen::Vector2d>;

DrawnLine wall(Points points_m) {
  return {LineKind::kWall, std::move(points_m)};
}

/// Two rooms of 2 x 2 m, cells of 0.1 m, with a wall two cells thick between them and no door.
OccupancyGrid closed_rooms() {
  GridFrame frame;
  frame.columns = 44;
  frame.rows = 22;
  OccupancyGrid grid(frame, CellState::kOccupied);
  fill_box(grid, {1, 1}, {20, 20}, CellState::kFree);
  fill_box(grid, {23, 1}, {42, 20}, CellState::kFree);
  return grid;
}

HybridMap map_of_lines(OccupancyGrid grid, const std::vector<DrawnLine>& lines,
                       const std::vector<DrawnZone>& zones = {},
                       const InflationConfig& inflation = {}) {
  FreeSpace space(std::move(grid), inflation, zones, lines);
  ZoneMap parts = drawn_zones(space, zones);
  return {std::move(space), std::move(parts)};
}

bool reaches(const HybridMap& map, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  return HybridPlanner(map, {}).plan(from_m, to_m).found();
}

/// Whether a segment touches a square of side 1 at `low`, by clipping it to the square.
bool touches(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& low) {
  double from = 0.0;
  double to = 1.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double way = b[axis] - a[axis];
    if (way == 0.0) {
      if (a[axis] < low[axis] || a[axis] > low[axis] + 1.0) return false;
      continue;
    }
    const double one = (low[axis] - a[axis]) / way;
    const double other = (low[axis] + 1.0 - a[axis]) / way;
    from = std::max(from, std::min(one, other));
    to = std::min(to, std::max(one, other));
  }
  return from <= to;
}

TEST(DrawnLines, WhereTheRobotMayBeIsTheDefinition) {
  support::Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const BlockFloor floor = block_floor({2, 2, 30, 25, 8, 1}, 20 + trial);
    const GridFrame& frame = floor.grid.frame();
    const auto anywhere = [&] {
      return Eigen::Vector2d(8.0 * random.uniform() - 1.0, 7.0 * random.uniform() - 1.0);
    };
    const std::vector<DrawnLine> lines{wall({anywhere(), anywhere(), anywhere()}),
                                       {LineKind::kOpening, {anywhere(), anywhere()}},
                                       {LineKind::kDoor, {anywhere(), anywhere()}, "door"}};
    const FreeSpace space(floor.grid, {2.0, false, 0.0}, {}, lines);
    OccupancyGrid expected = floor.grid;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      for (std::size_t k = 0; k < 2; ++k) {
        if (touches(frame.in_cells(lines[0].points_m[k]), frame.in_cells(lines[0].points_m[k + 1]),
                    {cell.column, cell.row})) {
          expected.set(cell, CellState::kOccupied);
        }
      }
      for (std::size_t line = 1; line < 3; ++line) {
        const Points& p = lines[line].points_m;
        const Eigen::Vector2d along = (p[1] - p[0]).normalized();
        const Eigen::Vector2d to_cell = frame.center_m(cell) - p[0];
        const double share = to_cell.dot(along);
        if (share < 0.0 || share > (p[1] - p[0]).norm()) continue;
        if ((to_cell - share * along).norm() <= kOpeningReach_m) {
          expected.set(cell, CellState::kFree);
        }
      }
    }
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      EXPECT_EQ(space.grid().at(cell), expected.at(cell)) << trial << ": " << i;
      EXPECT_EQ(space.seen().at(cell), floor.grid.at(cell));
      bool near = expected.at(cell) != CellState::kFree;
      for (std::size_t j = 0; j < frame.size() && !near; ++j) {
        const Cell other = frame.cell_at(j);
        near = expected.at(other) == CellState::kOccupied &&
               std::hypot(other.column - cell.column, other.row - cell.row) <= 2.0;
      }
      EXPECT_EQ(space.passable(cell), !near) << trial << ": " << cell.column << ' ' << cell.row;
    }
  }
}

TEST(DrawnLines, AWallIsGoneRoundOrClosesTheWay) {
  GridFrame frame;
  frame.columns = frame.rows = 60;
  OccupancyGrid hall(frame, CellState::kOccupied);
  fill_box(hall, {1, 1}, {58, 58}, CellState::kFree);
  const Eigen::Vector2d from_m(1.0, 3.0);
  const Eigen::Vector2d to_m(5.0, 3.0);
  const HybridMap open = map_of_lines(hall, {});
  EXPECT_NEAR(HybridPlanner(open, {}).plan(from_m, to_m).length_m, 4.0, 0.1);
  const HybridMap half = map_of_lines(hall, {wall({{3.0, 0.0}, {3.0, 4.0}})});
  const HybridRoute round = HybridPlanner(half, {}).plan(from_m, to_m);
  ASSERT_TRUE(round.found()) << round.reason;
  expect_drivable(half.space(), round);
  EXPECT_GT(round.length_m, 2.0 * std::hypot(2.0, 1.0));
  const HybridMap whole = map_of_lines(hall, {wall({{3.0, -1e6}, {3.0, 1e6}})});
  EXPECT_FALSE(reaches(whole, from_m, to_m));
  const HybridMap gap = map_of_lines(
      hall, {wall({{3.0, 0.0}, {3.0, 6.0}}), {LineKind::kOpening, {{3.0, 1.0}, {3.0, 2.2}}}});
  EXPECT_TRUE(reaches(gap, from_m, to_m));
}

TEST(DrawnLines, AnOpeningJoinsWhatAMappedWallParts) {
  const Eigen::Vector2d left_m(1.0, 1.0);
  const Eigen::Vector2d right_m(3.4, 1.0);
  EXPECT_FALSE(reaches(map_of_lines(closed_rooms(), {}), left_m, right_m));
  const HybridMap open =
      map_of_lines(closed_rooms(), {{LineKind::kOpening, {{2.2, 0.4}, {2.2, 1.7}}}});
  EXPECT_TRUE(reaches(open, left_m, right_m));
  EXPECT_EQ(open.space().seen().at({21, 10}), CellState::kOccupied) << "as sensors see it";
  EXPECT_EQ(open.space().grid().at({21, 10}), CellState::kFree);
}

TEST(DrawnLines, RoomsMeetAtADoor) {
  OccupancyGrid hall(closed_rooms());
  fill_box(hall, {21, 1}, {22, 20}, CellState::kFree);  // one hall
  const InflationConfig inflation{1.0, false, 0.0};
  const std::vector<DrawnLine> door{{LineKind::kDoor, {{2.2, 0.1}, {2.2, 2.1}}, "door"}};
  for (const bool drawn_rooms : {false, true}) {
    const auto zones_with = [&](std::span<const DrawnLine> lines) {
      const FreeSpace space(hall, inflation, {}, lines);
      return drawn_rooms ? drawn_zones(space, {}) : zones_of_rooms(space);
    };
    EXPECT_EQ(zones_with({}).zones.size(), 1U);
    const ZoneMap parted = zones_with(door);
    ASSERT_EQ(parted.zones.size(), 2U);
    const GridFrame& frame = hall.frame();
    EXPECT_NE(parted.zone_of_cell[frame.index({10, 10})],
              parted.zone_of_cell[frame.index({34, 10})]);
    // Everything to the left of the door is one room.
    for (std::int32_t column = 3; column < 21; ++column) {
      EXPECT_EQ(parted.zone_of_cell[frame.index({column, 10})],
                parted.zone_of_cell[frame.index({10, 10})]);
    }
  }
  // A drawn room stays whole.
  const std::vector<DrawnZone> room{{"hall", {{0, 0}, {4.4, 0}, {4.4, 2.2}, {0, 2.2}}}};
  const FreeSpace space(hall, inflation, room, door);
  EXPECT_EQ(drawn_zones(space, room).zones.size(), 1U);
}

TEST(DrawnLines, BranchesEndAtWalls) {
  topomap::GlobalMap map;
  add_map_node(map, 1, 0.0, 0.0);
  add_map_node(map, 2, 10.0, 0.0);
  add_map_branch(map, 10, 1, 2);
  const auto route_with = [&](const std::vector<DrawnLine>& lines) {
    PlanScene scene;
    scene.lines = lines;
    return plan(map, {1.0, 0.0}, {9.0, 0.0}, {}, scene);
  };
  EXPECT_TRUE(route_with({}).found());
  EXPECT_EQ(route_with({wall({{5.05, -2.0}, {5.05, 2.0}})}).status, PlanStatus::kClosed);
  EXPECT_TRUE(route_with({wall({{5.05, 2.0}, {5.05, 3.0}})}).found());
  EXPECT_TRUE(route_with({wall({{5.05, -2.0}, {5.05, 2.0}}),
                          {LineKind::kOpening, {{5.05, -1.5}, {5.05, 1.5}}}})
                  .found());
}

TEST(DrawnLines, WhatAScanShowsOpenAWallStillCloses) {
  GridFrame frame;
  frame.columns = frame.rows = 20;
  const std::vector<DrawnLine> lines{wall({{1.05, 0.0}, {1.05, 2.0}})};
  const FreeSpace space(OccupancyGrid(frame, CellState::kUnknown), {0.0, false, 0.0}, {}, lines);
  const std::vector<Cell> row{{9, 5}, {10, 5}, {11, 5}};
  const FreeSpace opened = space.opened(row, {});
  EXPECT_TRUE(opened.passable(Cell{9, 5}));
  EXPECT_FALSE(opened.passable(Cell{10, 5}));
}

TEST(FloorGrid, HasWallsWithOpeningsAndNothingOutside) {
  const std::vector<DrawnLine> lines{wall({{0, 0}, {6, 0}, {6, 4}, {0, 4}, {0, 0}}),
                                     wall({{3, 0}, {3, 4}}),
                                     DrawnLine{LineKind::kDoor, {{3, 1}, {3, 2}}, "door"}};
  const OccupancyGrid grid = grid_of_floor(lines, {1.0, 2.0});
  const auto at = [&](double x_m, double y_m) {
    return grid.at(grid.frame().cell_of({x_m, y_m}).value());
  };
  EXPECT_EQ(at(1.0, 2.0), CellState::kFree);
  EXPECT_EQ(at(5.0, 2.0), CellState::kFree);
  EXPECT_EQ(at(3.05, 3.0), CellState::kOccupied);
  EXPECT_EQ(at(3.05, 1.5), CellState::kFree);
  EXPECT_EQ(at(-0.5, 2.0), CellState::kUnknown);
  EXPECT_THROW(grid_of_floor(lines, {3.05, 3.5}), std::invalid_argument);
  EXPECT_THROW(grid_of_floor(lines, {100.0, 0.0}), std::invalid_argument);
  EXPECT_THROW(grid_of_floor({}, {0.0, 0.0}), std::invalid_argument);
}

TEST(ZoneDrawingFile, IsReadAsItIsWritten) {
  ZoneDrawing drawn;
  drawn.zones = {{"hall, large", {{0, 0}, {4, 0}, {4, 1.0 / 3.0}}},
                 {"ramp: slow", {{5, 0}, {6, 0}, {6, 1}}, ZoneKind::kSlow, 0.3},
                 {"- lane", {{7, 0}, {8, 0}, {8, 1}}, ZoneKind::kOneWay, -1.5}};
  drawn.places = {{"7", {1.0, -2.5}}, {"base \"station\"", {0.1, 0.2}, 1.25}};
  drawn.lines = {wall({{0, 0}, {4, 0}, {4, 3}}),
                 {LineKind::kOpening, {{1, 0}, {2, 0}}},
                 {LineKind::kDoor, {{4, 1}, {4, 2}}, "front # door"}};
  const ZoneDrawing read = parse_zone_drawing(zone_drawing_text(drawn), "text");
  ASSERT_EQ(read.zones.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read.zones[i].name, drawn.zones[i].name);
    EXPECT_EQ(read.zones[i].kind, drawn.zones[i].kind);
    EXPECT_EQ(read.zones[i].value, drawn.zones[i].value);
    EXPECT_EQ(read.zones[i].polygon_m, drawn.zones[i].polygon_m);
  }
  EXPECT_EQ(read.places, drawn.places);
  EXPECT_EQ(read.lines, drawn.lines);
  const ZoneDrawing nothing =
      parse_zone_drawing(zone_drawing_text({}), "of a floor with walls alone");
  EXPECT_TRUE(nothing.zones.empty() && nothing.places.empty() && nothing.lines.empty());
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_zone_drawing(text, "f.yaml"));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(refusal("walls: [{points: [[0, 0]]}]"), HasSubstr("two points [x, y] or more"));
  EXPECT_THAT(refusal("openings: [{points: [[0, 0], [0, 0]]}]"), HasSubstr("that differ"));
  EXPECT_THAT(refusal("doors: [{points: [[0, 0], [1, 0]]}]"), HasSubstr("name"));
  EXPECT_THAT(refusal("walls: [{line: 1}]"), HasSubstr("line"));
}

double area_m2(const Points& outline_m) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline_m.size(); ++i) {
    const Eigen::Vector2d& a = outline_m[i];
    const Eigen::Vector2d& b = outline_m[(i + 1) % outline_m.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

TEST(ZoneOutlines, JoinAndPartRooms) {
  OccupancyGrid grid = closed_rooms();
  fill_box(grid, {21, 8}, {22, 13}, CellState::kFree);  // a door
  const FreeSpace space(grid, {0.0, false, 0.0});
  const std::vector<DrawnZone> rooms{{"left", {{0, 0}, {2.2, 0}, {2.2, 2.2}, {0, 2.2}}},
                                     {"right", {{2.2, 0}, {4.4, 0}, {4.4, 2.2}, {2.2, 2.2}}}};
  const ZoneMap zones = drawn_zones(space, rooms);
  ASSERT_EQ(zones.zones.size(), 2U);
  const std::vector<ZoneId> left{0};
  const std::vector<ZoneId> both{0, 1};
  const auto outlines = [&](std::span<const ZoneId> ids, auto... cut) {
    return outlines_of(space.frame(), zones, ids, cut...);
  };
  ASSERT_EQ(outlines(left).size(), 1U);
  // The cells of the zone and the walls around it, one cell on the outside and two inside.
  EXPECT_NEAR(area_m2(outlines(left)[0]), 2.2 * 2.2, 0.3);
  ASSERT_EQ(outlines(both).size(), 1U);
  EXPECT_NEAR(area_m2(outlines(both)[0]), 4.4 * 2.2, 0.3);
  // Drawing these outlines gives the same rooms again.
  const std::vector<DrawnZone> joined{{"one", outlines(both)[0]}};
  EXPECT_EQ(drawn_zones(space, joined).zones.size(), 1U);
  const auto parted =
      outlines(left, std::pair<Eigen::Vector2d, Eigen::Vector2d>({0.3, 1.0}, {2.0, 1.0}));
  ASSERT_EQ(parted.size(), 2U);
  EXPECT_NEAR(area_m2(parted[0]) + area_m2(parted[1]), area_m2(outlines(left)[0]), 0.2);
  EXPECT_GT(std::min(area_m2(parted[0]), area_m2(parted[1])), 2.0);
  // A line that ends in the middle does not split the room.
  EXPECT_EQ(
      outlines(left, std::pair<Eigen::Vector2d, Eigen::Vector2d>({0.1, 1.0}, {0.6, 1.0})).size(),
      1U);
  EXPECT_TRUE(outlines(std::vector<ZoneId>{7}).empty());
}

// The zones meet on an invisible line in a wide gap: a line drawn to the gap ends before it.
TEST(ZoneOutlines, ALineThatEndsInAGapParts) {
  constexpr double kThick_m = 1.4;
  GridFrame frame;  // two rooms of 4 x 4 m, cells of 0.1 m, and a gap of 2.4 m through a thick wall
  frame.columns = 98;
  frame.rows = 42;
  OccupancyGrid grid(frame, CellState::kOccupied);
  fill_box(grid, {1, 1}, {40, 40}, CellState::kFree);
  fill_box(grid, {55, 1}, {96, 40}, CellState::kFree);
  fill_box(grid, {41, 9}, {54, 32}, CellState::kFree);
  const FreeSpace space(grid, {0.0, false, 0.0});
  const double border_m = 4.1 + 0.9 * kThick_m;
  const std::vector<DrawnZone> rooms{
      {"left", {{0, 0}, {border_m, 0}, {border_m, 4.2}, {0, 4.2}}},
      {"right", {{border_m, 0}, {9.8, 0}, {9.8, 4.2}, {border_m, 4.2}}}};
  const ZoneMap zones = drawn_zones(space, rooms);
  const std::vector<ZoneId> left{0};
  const auto parts = [&](const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
    return outlines_of(space.frame(), zones, left, std::pair(from_m, to_m)).size();
  };
  EXPECT_EQ(parts({0.1, 2.1}, {4.2, 2.1}), 2U);  // straight, to where the wall begins
  EXPECT_EQ(parts({0.1, 1.0}, {4.2, 2.3}), 2U);  // askew
  EXPECT_EQ(parts({4.2, 2.3}, {0.1, 1.0}), 2U);  // in the other direction
  EXPECT_EQ(parts({3.0, 0.1}, {4.3, 2.9}), 2U);  // past the gap, against its far side
  EXPECT_EQ(parts({3.7, 0.1}, {3.7, 4.1}), 2U);  // from wall to wall beside the gap: no third part
  EXPECT_EQ(parts({0.1, 2.1}, {3.0, 2.1}), 1U);  // ends too far from the gap
  EXPECT_EQ(parts({0.1, 0.6}, {3.2, 0.6}), 1U);  // ends before a wall, with the other room behind
}

}  // namespace
}  // namespace topogeo::planning
