#include "topogeo/exchange/grid_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/relocalization/global_localization.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/storage/map_file.hpp"

#include "planning/floors.hpp"
#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using planning::CellState;

/// Cells of 0.1 m: a room of 6 x 5 m, a door of 1 m, a corridor of 9 x 2 m behind it with a niche
/// at its end.
planning::OccupancyGrid small_floor() {
  planning::GridFrame frame;
  frame.columns = 160;
  frame.rows = 60;
  frame.resolution_m = 0.1;
  frame.T_map_grid = {-2.0, 1.0, 0.0};
  planning::OccupancyGrid grid(frame, CellState::kOccupied);
  const auto fill = [&](std::int32_t c0, std::int32_t r0, std::int32_t c1, std::int32_t r1) {
    planning::fill_box(grid, {c0, r0}, {c1, r1}, CellState::kFree);
  };
  fill(2, 4, 61, 53);
  fill(62, 25, 63, 34);
  fill(64, 20, 153, 39);
  fill(134, 40, 147, 52);
  return grid;
}

storage::MapDocument small_map(const GridMapSettings& settings = {}) {
  return map_of_grid(planning::FreeSpace(small_floor()), {}, {}, "plan", settings);
}

TEST(GridMap, ReportsEachStopAndTheEnd) {
  std::vector<std::pair<std::size_t, std::size_t>> calls;
  GridMapSettings settings;
  settings.progress = [&](std::size_t done, std::size_t total) { calls.emplace_back(done, total); };
  const storage::MapDocument map = small_map(settings);
  ASSERT_EQ(calls.size(), map.local_maps.size() + 1);
  for (std::size_t i = 0; i < calls.size(); ++i) {
    EXPECT_EQ(calls[i], std::make_pair(i + 1, calls.size()));
  }
  EXPECT_EQ(map.map_id, small_map().map_id) << "it changes nothing";
}

TEST(GridMap, BeamsEndInTheFirstOccupiedCell) {
  const planning::OccupancyGrid grid = small_floor();
  const Eigen::Vector2d from(1.0, 3.0);
  for (int i = 0; i < 720; ++i) {
    const double heading = (i + 0.37) * std::numbers::pi / 360.0;
    const float range_m = cast_beam(grid, from, heading, 30.0);
    // Follows a beam in small steps, which can only miss the corner of a cell.
    double stepped_m = 0.0;
    const Eigen::Vector2d along(std::cos(heading), std::sin(heading));
    while (grid.at(*grid.frame().cell_of(from + stepped_m * along)) == CellState::kFree) {
      stepped_m += 0.001;
    }
    EXPECT_NEAR(range_m, stepped_m + 0.05, 0.1) << i;
  }
}

TEST(GridMap, BeamsBeyondTheRangeOrIntoTheUnknownSeeNothing) {
  planning::OccupancyGrid grid = small_floor();
  EXPECT_EQ(cast_beam(grid, {1.0, 3.0}, 0.0, 2.0), scan::Scan::kNoReturn);
  EXPECT_GT(cast_beam(grid, {1.0, 3.0}, std::numbers::pi, 20.0), 2.0F);
  grid.set(*grid.frame().cell_of({-0.5, 3.0}), CellState::kUnknown);
  EXPECT_EQ(cast_beam(grid, {1.0, 3.0}, std::numbers::pi, 20.0), scan::Scan::kNoReturn);
}

TEST(GridMap, AGridBecomesAGraphThroughItsDoors) {
  const storage::MapDocument map = small_map();
  ASSERT_FALSE(map.global_map.branches.empty());
  const planning::FreeSpace space(small_floor());
  // The graph covers all connected free space, from the room to the niche.
  std::map<std::uint32_t, std::uint32_t> part;
  for (const topomap::MapNode& node : map.global_map.nodes) part[node.id] = node.id;
  for (std::size_t round = 0; round < part.size(); ++round) {
    for (const topomap::MapBranch& branch : map.global_map.branches) {
      part[branch.node_a] = part[branch.node_b] =
          std::min(part[branch.node_a], part[branch.node_b]);
    }
  }
  const auto nearest = [&](const Eigen::Vector2d& at_m) {
    return std::ranges::min(map.global_map.nodes, {}, [&](const topomap::MapNode& node) {
      return (node.position_m - at_m).norm();
    });
  };
  const topomap::MapNode room = nearest({1.2, 3.9});
  const topomap::MapNode niche = nearest({12.0, 5.5});
  EXPECT_LT((room.position_m - Eigen::Vector2d(1.2, 3.9)).norm(), 1.5);
  EXPECT_LT((niche.position_m - Eigen::Vector2d(12.0, 5.5)).norm(), 1.5);
  EXPECT_EQ(part[room.id], part[niche.id]);
  const topomap::MapNode door = nearest({4.3, 4.0});
  EXPECT_EQ(door.kind, topomap::NodeKind::kDoor);
  EXPECT_NEAR(door.clearance_m, 0.5, 0.15);
  for (const topomap::MapNode& node : map.global_map.nodes) {
    EXPECT_EQ(space.grid().at(*space.frame().cell_of(node.position_m)), CellState::kFree);
  }
}

TEST(GridMap, TheSameGridGivesTheSameBytes) {
  EXPECT_EQ(storage::map_file_bytes(small_map()), storage::map_file_bytes(small_map()));
}

TEST(GridMap, ARobotIsFoundInIt) {
  const storage::MapDocument map = small_map();
  const localization::GlobalLocalizer localizer(map.local_maps, map.trajectory);
  // A pose that differs from all stops.
  const geometry::Pose2 truth{0.3, 2.7, 0.7};
  std::vector<topomap::ScanPoint> points;
  for (int i = -180; i <= 180; ++i) {
    const double angle = i * std::numbers::pi / 360.0;
    const double range_m =
        cast_beam(small_floor(), truth.position_m(), truth.theta_rad + angle, 20.0);
    points.push_back({static_cast<float>(range_m * std::cos(angle)),
                      static_cast<float>(range_m * std::sin(angle))});
  }
  const localization::GlobalAnswer answer = localizer.find(points, {});
  ASSERT_FALSE(answer.poses.empty());
  EXPECT_NEAR(answer.poses[0].T_map_robot.x_m, truth.x_m, 0.1);
  EXPECT_NEAR(answer.poses[0].T_map_robot.y_m, truth.y_m, 0.1);
  EXPECT_NEAR(answer.poses[0].T_map_robot.theta_rad, truth.theta_rad, 0.03);
}

TEST(GridMap, StopsKeepTheirDistance) {
  const storage::MapDocument map = small_map({1.0, 20.0, 2.0});
  ASSERT_GT(map.local_maps.size(), 20U);
  for (std::size_t i = 0; i < map.local_maps.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((map.trajectory.stops[i].T_map_robot.position_m() -
                 map.trajectory.stops[j].T_map_robot.position_m())
                    .norm(),
                1.0 - 1e-9);
    }
  }
}

constexpr std::array<double, 9> kWidths_m = {5.0, 8.0, 8.0, 4.0, 6.0, 8.0, 5.0, 5.0, 8.0};

/// Cells of 0.05 m: two corridors of 58 x 2.4 m, joined at both ends and in the middle, with rooms
/// of several sizes behind doors of 0.9 m on their outer sides. Turned by almost 180 degrees.
planning::OccupancyGrid office_floor() {
  constexpr double kCell_m = 0.05;
  planning::GridFrame frame;
  frame.columns = 1200;
  frame.rows = 720;
  frame.resolution_m = kCell_m;
  frame.T_map_grid = {0.0, 0.0, 3.14};
  planning::OccupancyGrid grid(frame, CellState::kOccupied);
  const auto fill_m = [&](double left, double bottom, double right, double top) {
    const auto cell = [](double value) {
      return static_cast<std::int32_t>(std::lround(value / kCell_m));
    };
    planning::fill_box(grid, {cell(left), cell(bottom)}, {cell(right) - 1, cell(top) - 1},
                       CellState::kFree);
  };
  fill_m(1.0, 15.0, 59.0, 17.4);
  fill_m(1.0, 24.0, 59.0, 26.4);
  for (const double left : {1.0, 28.8, 56.6}) fill_m(left, 15.0, left + 2.4, 26.4);
  double left = 1.0;
  for (const double width : kWidths_m) {
    fill_m(left, 1.0, left + width - 0.2, 14.8);
    fill_m(left + 1.0, 14.8, left + 1.9, 15.0);
    fill_m(left, 26.6, left + width - 0.2, 35.0);
    fill_m(left + 1.0, 26.4, left + 1.9, 26.6);
    left += width;
  }
  return grid;
}

TEST(GridMap, ConnectedFreeSpaceGivesAConnectedGraph) {
  const planning::FreeSpace space(office_floor());
  const storage::MapDocument map = map_of_grid(space, {}, {}, "plan");
  EXPECT_EQ(parts_of_graph(map.global_map), 1U);
  // Each room has a node.
  double left_m = 1.0;
  for (const double width_m : kWidths_m) {
    for (const double middle_m : {8.0, 31.0}) {
      const Eigen::Vector2d half_m(0.5 * width_m - 0.1, middle_m < 15.0 ? 7.0 : 4.5);
      const Eigen::Vector2d room_m(left_m + half_m.x(), middle_m);
      EXPECT_TRUE(std::ranges::any_of(map.global_map.nodes, [&](const topomap::MapNode& node) {
        const Eigen::Vector2d away_m =
            space.frame().in_cells(node.position_m) * space.frame().resolution_m - room_m;
        return (away_m.cwiseAbs().array() < half_m.array()).all();
      })) << room_m.transpose();
    }
    left_m += width_m;
  }
  for (const topomap::MapBranch& branch : map.global_map.branches) {
    for (const topomap::BranchPoint& p : branch.points) {
      const auto cell = space.frame().cell_of(p.position_m);
      ASSERT_TRUE(cell);
      EXPECT_EQ(space.grid().at(*cell), CellState::kFree) << branch.id;
    }
  }
}

TEST(GridMap, RoomsWithoutADoorStayApart) {
  planning::GridFrame frame;
  frame.columns = 200;
  frame.rows = 60;
  frame.resolution_m = 0.1;
  planning::OccupancyGrid grid(frame, CellState::kOccupied);
  planning::fill_box(grid, {5, 5}, {94, 54}, CellState::kFree);
  planning::fill_box(grid, {105, 5}, {194, 54}, CellState::kFree);
  EXPECT_EQ(parts_of_graph(map_of_grid(planning::FreeSpace(grid), {}, {}, "plan").global_map), 2U);
}

TEST(GridMap, AGridWithoutAnObstacleIsAsWideAsItIsLarge) {
  planning::GridFrame frame;
  frame.columns = 60;
  frame.rows = 80;
  frame.resolution_m = 0.1;
  const planning::FreeSpace space(planning::OccupancyGrid(frame, CellState::kFree));
  const storage::MapDocument map = map_of_grid(space, {}, {}, "plan");
  ASSERT_FALSE(map.global_map.nodes.empty());
  for (const topomap::MapNode& node : map.global_map.nodes) EXPECT_LE(node.clearance_m, 10.0);
}

TEST(GridMap, AClosedGridHasNoStops) {
  planning::GridFrame frame;
  frame.columns = 30;
  frame.rows = 30;
  const planning::FreeSpace space(planning::OccupancyGrid(frame, CellState::kOccupied));
  const storage::MapDocument map = map_of_grid(space, {}, {}, "plan");
  EXPECT_TRUE(map.local_maps.empty());
  EXPECT_TRUE(map.drawing.grid);
}

}  // namespace
}  // namespace topogeo::exchange
