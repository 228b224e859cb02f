#include "topogeo/markov/obstacle_cells.hpp"

#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

TEST(ObstacleCells, TheUpperLineOfADrawingIsTheHighestRow) {
  const ObstacleCells map = test::drawn({"#..",  //
                                         "..#"});
  EXPECT_TRUE(map.occupied({0, 1}));
  EXPECT_TRUE(map.occupied({2, 0}));
  EXPECT_FALSE(map.occupied({0, 0}));
  EXPECT_TRUE(map.free({0, 0}));
  EXPECT_FALSE(map.free({2, 0}));
}

TEST(ObstacleCells, OutsideTheMapIsNeitherObstacleNorFree) {
  const ObstacleCells map = test::drawn({"##", "##"});
  for (const Cell cell : {Cell{-1, 0}, Cell{0, -1}, Cell{2, 0}, Cell{0, 2}, Cell{-1000, 1000}}) {
    EXPECT_FALSE(map.occupied(cell)) << cell.x << ", " << cell.y;
    EXPECT_FALSE(map.free(cell)) << cell.x << ", " << cell.y;
  }
}

TEST(ObstacleCells, WordsAgreeWithTheCellsOneByOne) {
  std::mt19937 random{7};
  std::vector<std::uint8_t> cells(std::size_t{150} * 5);
  for (std::uint8_t& cell : cells) cell = random() % 3 == 0 ? 1 : 0;
  const ObstacleCells map{{.width = 150, .height = 5, .resolution_m = 0.1, .occupied = cells}};
  const auto truth = [&](int x, int y) {
    return x >= 0 && x < 150 && y >= 0 && y < 5 &&
           cells[static_cast<std::size_t>(y) * 150 + static_cast<std::size_t>(x)] != 0;
  };
  for (int y = -1; y <= 5; ++y) {
    for (int x = -130; x <= 160; ++x) {
      const std::uint64_t occupied = map.occupied_bits(x, y);
      const std::uint64_t inside = map.inside_bits(x, y);
      for (int i = 0; i < 64; ++i) {
        ASSERT_EQ(((occupied >> i) & 1U) != 0, truth(x + i, y)) << x << ", " << y << ", " << i;
        ASSERT_EQ(((inside >> i) & 1U) != 0, map.inside({x + i, y})) << x << ", " << y << ", " << i;
      }
    }
  }
}

TEST(ObstacleCells, TheWindowSaysWhichOfItsCellsAreFree) {
  std::mt19937 random{8};
  std::vector<std::uint8_t> cells(std::size_t{90} * 90);
  for (std::uint8_t& cell : cells) cell = random() % 4 == 0 ? 1 : 0;
  const ObstacleCells map{{.width = 90, .height = 90, .resolution_m = 0.1, .occupied = cells}};
  for (const int size : {5, 21, 63, 65, 101}) {
    std::vector<RowBits> rows;
    const Cell centre{30, 70};
    free_cells_of_window(map, centre, size, rows);
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < 128; ++x) {
        const bool free = x < size && map.free({centre.x - size / 2 + x, centre.y - size / 2 + y});
        ASSERT_EQ(bit_of(rows[static_cast<std::size_t>(y)], x), free) << size << ": " << x << y;
      }
    }
  }
}

TEST(ObstacleCells, FineCellsBecomeCoarseOnesThatHideNoObstacle) {
  const ObstacleCells map = test::drawn({"....#",  //
                                         ".....",  //
                                         ".#..."},
                                        0.05, 2);
  EXPECT_EQ(map.width(), 3);
  EXPECT_EQ(map.height(), 2);
  EXPECT_DOUBLE_EQ(map.cell_m(), 0.1);
  EXPECT_TRUE(map.occupied({0, 0}));
  EXPECT_TRUE(map.occupied({2, 1}));
  EXPECT_TRUE(map.free({1, 0}));
  EXPECT_TRUE(map.free({1, 1}));
}

TEST(ObstacleCells, PointsAndCells) {
  const std::vector<std::uint8_t> cells(12, 0);
  const ObstacleCells map{
      {.width = 4, .height = 3, .resolution_m = 0.1, .origin_m = {-1.0, 2.0}, .occupied = cells}};
  EXPECT_EQ(map.cell_of({-0.95, 2.05}), (Cell{0, 0}));
  EXPECT_EQ(map.cell_of({-1.05, 2.25}), (Cell{-1, 2}));
  EXPECT_NEAR(map.centre_m({3, 1}).x(), -0.65, 1e-12);
  EXPECT_NEAR(map.centre_m({3, 1}).y(), 2.15, 1e-12);
  EXPECT_NEAR(map.place_in_cell({-0.93, 2.15}).x(), 0.7, 1e-9);
  EXPECT_FALSE(map.inside(map.cell_of({1e300, -1e300})));
}

TEST(ObstacleCells, BadViewsAreRefused) {
  const std::vector<std::uint8_t> cells(6, 0);
  const CellsView good{.width = 3, .height = 2, .resolution_m = 0.1, .occupied = cells};
  EXPECT_NO_THROW(ObstacleCells{good});
  CellsView bad = good;
  bad.width = 0;
  EXPECT_THROW(ObstacleCells{bad}, std::invalid_argument);
  bad = good;
  bad.height = 3;
  EXPECT_THROW(ObstacleCells{bad}, std::invalid_argument);
  bad = good;
  bad.resolution_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ObstacleCells{bad}, std::invalid_argument);
  bad = good;
  bad.origin_m.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(ObstacleCells{bad}, std::invalid_argument);
  EXPECT_THROW((ObstacleCells{good, 0}), std::invalid_argument);
  EXPECT_THROW((ObstacleCells{good, 11}), std::invalid_argument);  // cells of 1.1 m
}

}  // namespace
}  // namespace topogeo::markov
