#include "topogeo/markov/belief_grid.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

TEST(BeliefGrid, SidesAreOddAndFrom5To101) {
  for (const int size : {-21, 0, 3, 20, 103}) {
    EXPECT_THROW(BeliefGrid{size}, std::invalid_argument) << size;
  }
  for (const int size : {5, 21, 101}) {
    const BeliefGrid grid{size};
    EXPECT_EQ(grid.current().size(), static_cast<std::size_t>(size * size));
    EXPECT_EQ(grid.sum(), 0.0);
  }
  EXPECT_EQ(BeliefGrid{}.size(), 21);
}

TEST(BeliefGrid, AnUpdateKeepsTheStateFromBefore) {
  BeliefGrid grid{5};
  grid.set({1, -2}, 0.25);
  grid.begin_update();
  EXPECT_EQ(grid.at({1, -2}), 0.0);
  EXPECT_EQ(grid.previous()[3], 0.25);  // lowest row, fourth column
}

TEST(BeliefGrid, OutsideTheWindowThereIsNothing) {
  BeliefGrid grid{5};
  EXPECT_EQ(grid.at({3, 0}), 0.0);
  EXPECT_EQ(grid.at({0, -3}), 0.0);
  EXPECT_THROW(grid.set({3, 0}, 0.5), std::out_of_range);
}

TEST(BeliefGrid, TheWindowGoesAlongWithTheRobot) {
  BeliefGrid grid{5};
  grid.set({1, 2}, 0.5);
  grid.carry_to({40, -7});
  EXPECT_EQ(grid.centre(), (Cell{40, -7}));
  EXPECT_EQ(grid.at({1, 2}), 0.5);
}

TEST(BeliefGrid, RecentringLeavesProbabilitiesAtTheirCellsOfTheMap) {
  BeliefGrid grid{5};
  grid.carry_to({10, 10});
  grid.set({2, 1}, 0.5);    // cell (12, 11)
  grid.set({0, 0}, 0.25);   // cell (10, 10)
  grid.set({-2, 0}, 0.25);  // cell (8, 10), outside the new window
  grid.recentre({12, 11});
  EXPECT_EQ(grid.at({0, 0}), 0.5);
  EXPECT_EQ(grid.at({-2, -1}), 0.25);
  EXPECT_DOUBLE_EQ(grid.sum(), 0.75);
}

TEST(BeliefGrid, RecentringFarAwayLeavesNothing) {
  BeliefGrid grid{5};
  grid.carry_to({-1000000000, 0});
  grid.set({0, 0}, 1.0);
  grid.recentre({2000000000, 5});
  EXPECT_EQ(grid.sum(), 0.0);
}

TEST(BeliefGrid, ObstaclesHaveZero) {
  const ObstacleCells map = test::drawn({"#....",  //
                                         ".....",  //
                                         "...#.",  //
                                         ".....",  //
                                         "....#"});
  std::vector<RowBits> free;
  free_cells_of_window(map, {2, 2}, 5, free);
  BeliefGrid grid{5};
  for (double& probability : grid.current()) probability = 0.04;
  grid.keep_only(free);
  EXPECT_EQ(grid.at({-2, 2}), 0.0);
  EXPECT_EQ(grid.at({1, 0}), 0.0);
  EXPECT_EQ(grid.at({2, -2}), 0.0);
  EXPECT_DOUBLE_EQ(grid.sum(), 0.88);
}

TEST(BeliefGrid, NormalizingGivesASumOfOneAndForgetsWhatIsNegligible) {
  BeliefGrid grid{5};
  grid.set({0, 0}, 0.3);
  grid.set({1, 0}, 0.1);
  grid.set({2, 0}, 1e-17);
  EXPECT_DOUBLE_EQ(grid.normalize(), 0.4);
  EXPECT_DOUBLE_EQ(grid.at({0, 0}), 0.75);
  EXPECT_DOUBLE_EQ(grid.at({1, 0}), 0.25);
  EXPECT_EQ(grid.at({2, 0}), 0.0);
}

TEST(BeliefGrid, NothingStaysNothing) {
  BeliefGrid grid{5};
  EXPECT_EQ(grid.normalize(), 0.0);
  EXPECT_EQ(grid.sum(), 0.0);
}

}  // namespace
}  // namespace topogeo::markov
