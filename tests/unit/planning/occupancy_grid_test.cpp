#include "topogeo/planning/occupancy_grid.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/free_space.hpp"

#include "floors.hpp"

namespace topogeo::planning {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

GridFrame frame_of(std::int32_t columns, std::int32_t rows, double resolution_m = 0.1) {
  GridFrame frame;
  frame.columns = columns;
  frame.rows = rows;
  frame.resolution_m = resolution_m;
  return frame;
}

TEST(GridFrame, FindsTheCellOfAPoint) {
  GridFrame frame = frame_of(10, 20);
  frame.T_map_grid = {-1.0, 2.0, 0.0};
  EXPECT_EQ(frame.cell_of({-1.0, 2.0}), (Cell{0, 0}));
  EXPECT_EQ(frame.cell_of({-0.75, 2.35}), (Cell{2, 3}));
  EXPECT_EQ(frame.cell_of({-0.05, 3.95}), (Cell{9, 19}));
  EXPECT_EQ(frame.cell_of({0.01, 3.0}), std::nullopt);
  EXPECT_EQ(frame.cell_of({-0.5, 1.99}), std::nullopt);
  EXPECT_EQ(frame.cell_of({std::numeric_limits<double>::quiet_NaN(), 3.0}), std::nullopt);
}

TEST(GridFrame, GoesFromACellToTheMapAndBackHoweverItIsTurned) {
  for (const double yaw_rad : {0.0, 0.4, -2.5}) {
    GridFrame frame = frame_of(7, 5, 0.05);
    frame.T_map_grid = {3.0, -4.0, yaw_rad};
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell cell = frame.cell_at(i);
      EXPECT_EQ(frame.index(cell), i);
      EXPECT_EQ(frame.cell_of(frame.center_m(cell)), cell);
    }
  }
  GridFrame quarter = frame_of(4, 4, 1.0);
  quarter.T_map_grid = {0.0, 0.0, std::acos(0.0)};
  EXPECT_NEAR((quarter.center_m({2, 0}) - Eigen::Vector2d(-0.5, 2.5)).norm(), 0.0, 1e-12);
}

TEST(OccupancyGrid, RefusesSizesOutOfRange) {
  const auto make = [](const GridFrame& frame) { return [frame] { OccupancyGrid grid(frame); }; };
  EXPECT_THAT(make(frame_of(0, 5)),
              ThrowsMessage<std::invalid_argument>(HasSubstr("columns is 0")));
  EXPECT_THAT(make(frame_of(20000, 20000)),
              ThrowsMessage<std::invalid_argument>(HasSubstr("columns x rows is 400000000")));
  EXPECT_THAT(make(frame_of(5, 5, 0.001)),
              ThrowsMessage<std::invalid_argument>(HasSubstr("expected 0.01 to 1 m")));
}

TEST(FreeSpace, ForbidsThreeCellsRoundAnObstacle) {
  const FreeSpace space(grid_of_text({
      ".........",
      ".........",
      ".........",
      ".........",
      "....#....",
      ".........",
      ".........",
      ".........",
      ".........",
  }));
  const std::vector<std::string> expected{
      "ooooooooo",  //
      "oooo.oooo",  //
      "oo.....oo",  //
      "oo.....oo",  //
      "o.......o",  //
      "oo.....oo",  //
      "oo.....oo",  //
      "oooo.oooo",  //
      "ooooooooo",  //
  };
  for (std::int32_t row = 0; row < 9; ++row) {
    for (std::int32_t column = 0; column < 9; ++column) {
      const bool passable =
          expected[static_cast<std::size_t>(8 - row)][static_cast<std::size_t>(column)] == 'o';
      EXPECT_EQ(space.passable(Cell{column, row}), passable) << column << ", " << row;
    }
  }
  EXPECT_DOUBLE_EQ(space.clearance_m({4, 4}), 0.0);
  EXPECT_DOUBLE_EQ(space.clearance_m({0, 1}), 5.0);
}

TEST(FreeSpace, KnowsTheNearestObstacleOfEveryCell) {
  support::Random random(7);
  for (int round = 0; round < 20; ++round) {
    GridFrame frame = frame_of(1 + static_cast<std::int32_t>(random.below(40)),
                               1 + static_cast<std::int32_t>(random.below(30)));
    OccupancyGrid grid(frame, CellState::kFree);
    for (std::uint64_t k = random.below(12); k > 0; --k) {
      grid.set(frame.cell_at(random.below(frame.size())), CellState::kOccupied);
    }
    const FreeSpace space(grid);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      std::int32_t nearest = FreeSpace::kNoObstacle;
      for (std::size_t j = 0; j < frame.size(); ++j) {
        if (grid.cells()[j] != CellState::kOccupied) continue;
        const std::int32_t x = frame.cell_at(i).column - frame.cell_at(j).column;
        const std::int32_t y = frame.cell_at(i).row - frame.cell_at(j).row;
        nearest = std::min(nearest, x * x + y * y);
      }
      ASSERT_EQ(space.squared_cells(i), nearest);
    }
  }
}

TEST(FreeSpace, KeepsUnknownCellsOutAndTheirNeighboursIfTold) {
  const OccupancyGrid grid = grid_of_text({"...?..."});
  InflationConfig config;
  config.forbidden_cells = 1.0;
  const FreeSpace near(grid, config);
  EXPECT_FALSE(near.passable(Cell{3, 0}));
  EXPECT_TRUE(near.passable(Cell{2, 0}));
  EXPECT_TRUE(std::isinf(near.clearance_m({2, 0})));
  config.inflate_unknown = true;
  const FreeSpace far(grid, config);
  EXPECT_FALSE(far.passable(Cell{2, 0}));
  EXPECT_TRUE(far.passable(Cell{1, 0}));
  EXPECT_FALSE(far.passable(Cell{-1, 0}));
}

TEST(FreeSpace, RefusesAnInflationOutOfRange) {
  InflationConfig config;
  config.forbidden_cells = -1.0;
  EXPECT_THAT([&] { check(config); },
              ThrowsMessage<std::invalid_argument>(HasSubstr(
                  "'hybrid_map.forbidden_cells' = '-1': expected number between 0 and 100")));
}

}  // namespace
}  // namespace topogeo::planning
