#include "topogeo/planning/grid_sources.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::planning {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

CellState at(const OccupancyGrid& grid, double x_m, double y_m) {
  return grid.at(grid.frame().cell_of({x_m, y_m}).value());
}

Drawing box(double x0, double y0, double x1, double y1) {
  Drawing drawing;
  drawing.lines = {
      {{x0, y0}, {x1, y0}}, {{x1, y0}, {x1, y1}}, {{x1, y1}, {x0, y1}}, {{x0, y1}, {x0, y0}}};
  return drawing;
}

TEST(GridOfDrawing, DrawsWallsAndColumns) {
  Drawing drawing = box(0.0, 0.0, 4.0, 3.0);
  drawing.discs.push_back({{2.05, 1.55}, 0.2});
  const OccupancyGrid grid = grid_of(drawing, 0.1, 0.5);
  EXPECT_EQ(grid.frame().columns, 51);
  EXPECT_EQ(grid.frame().rows, 41);
  EXPECT_EQ(at(grid, 2.0, 0.05), CellState::kOccupied);
  EXPECT_EQ(at(grid, 2.0, 0.15), CellState::kFree);
  EXPECT_EQ(at(grid, 2.05, 1.55), CellState::kOccupied);
  EXPECT_EQ(at(grid, 2.25, 1.55), CellState::kOccupied);
  EXPECT_EQ(at(grid, 2.35, 1.55), CellState::kFree);
  EXPECT_EQ(at(grid, -0.3, 1.0), CellState::kFree);
}

TEST(GridOfDrawing, KnowsNothingOfWhatCannotBeReached) {
  Drawing drawing = box(0.0, 0.0, 4.0, 3.0);
  const Drawing cupboard = box(1.0, 1.0, 2.0, 2.0);
  drawing.lines.insert(drawing.lines.end(), cupboard.lines.begin(), cupboard.lines.end());
  drawing.inside_m = {{0.5, 0.5}};
  const OccupancyGrid grid = grid_of(drawing);
  EXPECT_EQ(at(grid, 3.5, 2.5), CellState::kFree);
  EXPECT_EQ(at(grid, 1.5, 1.5), CellState::kUnknown);
  EXPECT_EQ(at(grid, -0.5, 1.0), CellState::kUnknown);
}

// A flood across cell sides must not get through a wall at any angle.
TEST(GridOfDrawing, SlantingWallsHaveNoGaps) {
  for (int k = 0; k < 60; ++k) {
    const double angle_rad = 0.1047 * k;
    const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    const Eigen::Vector2d across(-along.y(), along.x());
    Drawing drawing;
    const std::vector<Eigen::Vector2d> corners{
        1.7 * along + 1.1 * across, -1.7 * along + 1.1 * across, -1.7 * along - 1.1 * across,
        1.7 * along - 1.1 * across};
    for (std::size_t i = 0; i < 4; ++i) {
      drawing.lines.push_back({corners[i], corners[(i + 1) % 4]});
    }
    drawing.inside_m = {{0.0, 0.0}};
    const OccupancyGrid grid = grid_of(drawing);
    EXPECT_EQ(at(grid, 0.0, 0.0), CellState::kFree);
    EXPECT_EQ(grid.at({0, 0}), CellState::kUnknown) << angle_rad;
  }
}

TEST(GridOfDrawing, RefusesWhatItCannotDraw) {
  EXPECT_THAT([] { grid_of(Drawing{}); }, ThrowsMessage<std::invalid_argument>(HasSubstr("empty")));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { grid_of(box(0.0, 0.0, nan, 1.0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not finite")));
  EXPECT_THAT([] { grid_of(box(0.0, 0.0, 1e6, 1.0)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("columns is")));
}

// A robot at `stop_m` that sees the square room |x|, |y| <= 2 m.
topomap::LocalMap scan_of_room(const Eigen::Vector2d& stop_m) {
  topomap::LocalMap map;
  for (int k = -39; k <= 39; ++k) {
    const double along_m = 0.05 * k;
    for (const Eigen::Vector2d& p :
         {Eigen::Vector2d(2.0, along_m), Eigen::Vector2d(-2.0, along_m),
          Eigen::Vector2d(along_m, 2.0), Eigen::Vector2d(along_m, -2.0)}) {
      const Eigen::Vector2d seen_m = p - stop_m;
      map.points.push_back({static_cast<float>(seen_m.x()), static_cast<float>(seen_m.y())});
    }
  }
  return map;
}

topomap::StopPose stop_at(double x_m, double y_m) {
  topomap::StopPose stop;
  stop.T_map_robot = {x_m, y_m, 0.0};
  return stop;
}

TEST(GridFromScans, TellsFreeOccupiedAndUnknownApart) {
  const std::vector<topomap::LocalMap> maps{scan_of_room({0.0, 0.0}), scan_of_room({0.5, -0.7})};
  const std::vector<topomap::StopPose> stops{stop_at(0.0, 0.0), stop_at(0.5, -0.7)};
  const OccupancyGrid grid = grid_from_scans(maps, stops);
  EXPECT_EQ(at(grid, 0.05, 0.05), CellState::kFree);
  EXPECT_EQ(at(grid, 1.85, 1.2), CellState::kFree);
  EXPECT_EQ(at(grid, 2.02, 0.55), CellState::kOccupied);
  EXPECT_EQ(at(grid, 2.5, 0.5), CellState::kUnknown);
  EXPECT_EQ(grid.frame().columns, 61);
}

TEST(GridFromScans, ForgetsWhatLaterScansLookThrough) {
  topomap::LocalMap crate = scan_of_room({0.0, 0.0});
  for (topomap::ScanPoint& p : crate.points) {
    if (p.x_m > 1.9F && std::fabs(p.y_m) < 0.5F) p = {0.5F * p.x_m, 0.5F * p.y_m};
  }
  const std::vector<topomap::LocalMap> maps{crate, scan_of_room({0.0, 0.0}),
                                            scan_of_room({0.0, 0.0}), scan_of_room({0.0, 0.0})};
  const std::vector<topomap::StopPose> stops(4, stop_at(0.0, 0.0));
  const std::span<const topomap::StopPose> all(stops);
  EXPECT_EQ(at(grid_from_scans(maps, all.first(1)), 1.01, 0.01), CellState::kOccupied);
  EXPECT_EQ(at(grid_from_scans(maps, all), 1.01, 0.01), CellState::kFree);
}

TEST(GridFromScans, LeavesOutStopsThatNobodyLocated) {
  const std::vector<topomap::LocalMap> maps{scan_of_room({0.0, 0.0}), scan_of_room({0.0, 0.0})};
  std::vector<topomap::StopPose> stops{stop_at(0.0, 0.0), stop_at(50.0, 0.0)};
  stops[1].located = false;
  EXPECT_EQ(grid_from_scans(maps, stops).frame().columns, 61);
}

// Tiles of 16 cells keep their cells when the map grows.
TEST(GridFromScans, CanBeginAtMultiplesOfManyCells) {
  ScanGridConfig config;
  config.snap_cells = 16;
  const std::vector<topomap::LocalMap> maps{scan_of_room({0.0, 0.0})};
  for (const double x_m : {0.0, 0.4, -0.9, 7.3}) {
    const std::vector<topomap::StopPose> stops{stop_at(x_m, 0.0)};
    const GridFrame frame = grid_from_scans(maps, stops, config).frame();
    EXPECT_EQ(frame.T_map_grid.x_m, std::floor((x_m - 3.0) / 1.6) * 16 * 0.1) << x_m;
    EXPECT_EQ(frame.T_map_grid.y_m, -32 * 0.1);
    EXPECT_EQ(frame.rows, 63);
    EXPECT_TRUE(frame.cell_of({x_m + 2.9, 2.9}).has_value());
  }
}

TEST(GridOfBoth, IsOccupiedWhereEitherSaysSo) {
  GridFrame frame;
  frame.columns = 40;
  frame.rows = 40;
  frame.T_map_grid = {-2.0, -2.0, 0.0};
  OccupancyGrid drawn(frame, CellState::kFree);
  drawn.set({10, 20}, CellState::kOccupied);  // the scan sees it free
  drawn.set({30, 30}, CellState::kUnknown);   // the scan sees it free
  const std::vector<topomap::LocalMap> maps{scan_of_room({0.0, 0.0})};
  const std::vector<topomap::StopPose> stops{stop_at(0.45, -0.35)};
  ScanGridConfig config;
  config.snap_cells = 8;
  const OccupancyGrid both = grid_of_both(drawn, maps, stops, config);
  EXPECT_EQ(at(both, -0.95, 0.05), CellState::kOccupied);
  EXPECT_EQ(at(both, 1.05, 1.05), CellState::kFree);
  EXPECT_EQ(at(both, -1.55, 0.55), CellState::kOccupied) << "only the scan has this wall";
  EXPECT_EQ(at(both, 2.45, 0.55), CellState::kOccupied) << "beyond the drawing";
  EXPECT_EQ(at(both, 2.2, 0.55), CellState::kFree) << "beyond the drawing";
  EXPECT_EQ(at(both, -1.8, 1.8), CellState::kFree) << "only the drawing has this";
  EXPECT_EQ(both.frame().columns, 45);
  EXPECT_EQ(both.frame().rows, 48) << "8 more below";
  EXPECT_EQ(both.frame().T_map_grid, (geometry::Pose2{-2.0, -2.0 - 8 * 0.1, 0.0}));
}

TEST(GridOfBoth, KeepsTheCellsOfATurnedDrawing) {
  GridFrame frame;
  frame.columns = 30;
  frame.rows = 20;
  frame.T_map_grid = {0.3, -0.2, 0.7};
  OccupancyGrid drawn(frame);
  for (std::int32_t i = 0; i < 20; ++i) drawn.set({i, i}, CellState::kOccupied);
  const std::vector<topomap::LocalMap> maps{scan_of_room({0.0, 0.0})};
  const std::vector<topomap::StopPose> stops{stop_at(0.0, 0.0)};
  const OccupancyGrid both = grid_of_both(drawn, maps, stops);
  for (std::int32_t i = 0; i < 20; ++i) {
    const Eigen::Vector2d middle_m = frame.center_m({i, i});
    EXPECT_EQ(at(both, middle_m.x(), middle_m.y()), CellState::kOccupied) << i;
  }
  EXPECT_EQ(at(both, 0.0, 1.0), CellState::kFree);
  EXPECT_EQ(at(both, -1.99, -1.0), CellState::kOccupied);
}

TEST(GridOfBoth, WithoutScansIsTheDrawing) {
  GridFrame frame;
  frame.columns = frame.rows = 3;
  OccupancyGrid drawn(frame, CellState::kFree);
  drawn.set({1, 1}, CellState::kOccupied);
  EXPECT_TRUE(std::ranges::equal(grid_of_both(drawn, {}, {}).cells(), drawn.cells()));
}

// Scan points and robot are on the rim of such a grid, where rounding decides the side.
TEST(GridFromScans, NeedsNoMargin) {
  ScanGridConfig config;
  config.margin_m = 0.0;
  for (int k = 0; k < 200; ++k) {
    topomap::LocalMap map;
    for (const double x_m : {-2.0, 2.0}) {
      for (const double y_m : {-1.0, 1.0}) {
        map.points.push_back({static_cast<float>(x_m), static_cast<float>(y_m)});
      }
    }
    topomap::StopPose stop;
    stop.located = true;
    stop.T_map_robot = {0.0137 * k, -0.0291 * k, 0.031 * k};
    const OccupancyGrid grid = grid_from_scans({&map, 1}, {&stop, 1}, config);
    const auto occupied =
        std::count(grid.cells().begin(), grid.cells().end(), CellState::kOccupied);
    EXPECT_GE(occupied, 1) << k;
    EXPECT_LE(occupied, 4) << k;
  }
}

TEST(GridFromScans, RefusesBadInput) {
  const std::vector<topomap::LocalMap> maps(1);
  const std::vector<topomap::StopPose> stops(2);
  EXPECT_THAT([&] { grid_from_scans(maps, stops); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("2 stops but 1 local maps")));
  EXPECT_THAT([&] { grid_from_scans(maps, std::span(stops).first(1)); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no stop with scan points")));
  ScanGridConfig config;
  config.hit = 0;
  EXPECT_THAT([&] { grid_from_scans(maps, {}, config); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(
                  "key 'hybrid_map.hit' = '0': expected whole number between 1 and 1000")));
}

}  // namespace
}  // namespace topogeo::planning
