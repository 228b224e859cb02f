#include "topogeo/planning/grid_search.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

constexpr double kRoot = std::numbers::sqrt2;

FreeSpace without_inflation(const std::vector<std::string>& lines) {
  InflationConfig config;
  config.forbidden_cells = 0.0;
  return FreeSpace(grid_of_text(lines), config);
}

SearchWindow whole_window(const FreeSpace& space) {
  return {space, whole(space.frame())};
}

TEST(GridSearch, GoesRoundACornerWithoutCuttingIt) {
  const FreeSpace space = without_inflation({
      "...",  //
      ".#.",  //
      "...",  //
  });
  const auto path = shortest_path(whole_window(space), {0, 1}, {1, 2});
  ASSERT_TRUE(path);
  EXPECT_EQ(path->cells, (std::vector<Cell>{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_DOUBLE_EQ(path->cost_cells, 2.0);
}

TEST(GridSearch, GoesDiagonallyWhereThereIsRoom) {
  const FreeSpace space = without_inflation({
      "....",  //
      "....",  //
      "....",  //
  });
  const auto path = shortest_path(whole_window(space), {0, 0}, {3, 2});
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->cost_cells, 1.0 + 2.0 * kRoot);
  EXPECT_EQ(path->cells.size(), 4U);
  EXPECT_DOUBLE_EQ(cost_cells(path->cells), path->cost_cells);
}

TEST(GridSearch, HasNoPathIntoObstaclesOrThroughAClosedDiagonal) {
  const FreeSpace space = without_inflation({
      "#.",  //
      ".#",  //
  });
  const SearchWindow window = whole_window(space);
  EXPECT_FALSE(shortest_path(window, {0, 0}, {1, 1}));
  EXPECT_FALSE(shortest_path(window, {0, 0}, {1, 0}));
  EXPECT_FALSE(shortest_path(window, {1, 0}, {0, 0}));
  EXPECT_FALSE(shortest_path(window, {0, 0}, {5, 5}));
  const auto stay = shortest_path(window, {0, 0}, {0, 0});
  ASSERT_TRUE(stay);
  EXPECT_EQ(stay->cells.size(), 1U);
  EXPECT_EQ(stay->cost_cells, 0.0);
}

TEST(GridSearch, EndsAtTheNearestOfSeveralCells) {
  const FreeSpace space = without_inflation({
      ".....",  //
      ".###.",  //
      ".....",  //
  });
  const SearchWindow window = whole_window(space);
  const std::vector<Cell> far_and_near = {{4, 0}, {0, 2}};
  const auto path = path_to_nearest(window, {0, 0}, far_and_near);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->cells, (std::vector<Cell>{{0, 0}, {0, 1}, {0, 2}}));
  const std::vector<Cell> occupied = {{2, 1}};
  EXPECT_FALSE(path_to_nearest(window, {0, 0}, occupied));
}

TEST(GridSearch, SlowCellsCostMore) {
  const FreeSpace space = without_inflation({
      ".....",  //
      ".....",  //
      ".....",  //
  });
  SearchWindow window = whole_window(space);
  std::vector<float> slowness(space.frame().size(), 9.0F);
  for (const Cell& fast : {Cell{0, 0}, Cell{0, 1}, Cell{0, 2}, Cell{1, 2}, Cell{2, 2}, Cell{3, 2},
                           Cell{4, 2}, Cell{4, 1}, Cell{4, 0}}) {
    slowness[space.frame().index(fast)] = 1.0F;
  }
  window.set_slowness(space.frame(), slowness);
  const auto path = shortest_path(window, {0, 0}, {4, 0});
  ASSERT_TRUE(path);
  EXPECT_DOUBLE_EQ(path->cost_cells, 4.0 + 2.0 * kRoot);
  for (const Cell& cell : path->cells) EXPECT_EQ(slowness[space.frame().index(cell)], 1.0F);
}

TEST(GridSearch, StaysInItsWindowAndOutOfWhatIsClosed) {
  const FreeSpace space = without_inflation({
      ".....",  //
      ".###.",  //
      ".....",  //
  });
  SearchWindow lower(space, {{0, 0}, {4, 1}});
  EXPECT_DOUBLE_EQ(shortest_path(lower, {0, 1}, {4, 1}).value().cost_cells, 6.0);
  lower.close({2, 0});
  EXPECT_FALSE(shortest_path(lower, {0, 1}, {4, 1}));
  SearchWindow all = whole_window(space);
  all.close_disc({2, 0}, 1.0);
  EXPECT_FALSE(all.open({1, 0}));
  EXPECT_TRUE(all.open({0, 0}));
  EXPECT_DOUBLE_EQ(shortest_path(all, {0, 1}, {4, 1}).value().cost_cells, 6.0);
}

// Relaxes every step until nothing changes.
std::vector<double> costs_by_relaxation(const FreeSpace& space, const Cell& from) {
  const GridFrame& frame = space.frame();
  std::vector<double> cost(frame.size(), std::numeric_limits<double>::infinity());
  if (space.passable(from)) cost[frame.index(from)] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const Cell a = frame.cell_at(i);
      for (std::int32_t y = -1; y <= 1; ++y) {
        for (std::int32_t x = -1; x <= 1; ++x) {
          const Cell b{a.column + x, a.row + y};
          if (!space.passable(b) || !space.passable({a.column + x, a.row}) ||
              !space.passable({a.column, a.row + y})) {
            continue;
          }
          const double through = cost[i] + (x != 0 && y != 0 ? kRoot : 1.0);
          if (through < cost[frame.index(b)] - 1e-9) {
            cost[frame.index(b)] = through;
            changed = true;
          }
        }
      }
    }
  }
  return cost;
}

TEST(GridSearch, FindsTheCheapestPathsOfRandomGrids) {
  support::Random random(11);
  for (int round = 0; round < 40; ++round) {
    std::vector<std::string> lines(12, std::string(15, '.'));
    for (std::string& line : lines) {
      for (char& c : line) c = random.below(100) < 30 ? '#' : '.';
    }
    const FreeSpace space = without_inflation(lines);
    const GridFrame& frame = space.frame();
    const Cell from = frame.cell_at(random.below(frame.size()));
    const std::vector<double> expected = costs_by_relaxation(space, from);
    const SearchWindow window = whole_window(space);
    std::vector<Cell> all;
    all.reserve(frame.size());
    for (std::size_t i = 0; i < frame.size(); ++i) all.push_back(frame.cell_at(i));
    const auto paths = shortest_paths(window, from, all);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const auto one = shortest_path(window, from, all[i]);
      ASSERT_EQ(one.has_value(), std::isfinite(expected[i]));
      ASSERT_EQ(paths[i].has_value(), one.has_value());
      if (!one) continue;
      ASSERT_NEAR(one->cost_cells, expected[i], 1e-9);
      ASSERT_NEAR(paths[i]->cost_cells, expected[i], 1e-9);
      ASSERT_NEAR(cost_cells(one->cells), expected[i], 1e-9);
      ASSERT_EQ(one->cells.front(), from);
      ASSERT_EQ(paths[i]->cells.back(), all[i]);
    }
  }
}

}  // namespace
}  // namespace topogeo::planning
