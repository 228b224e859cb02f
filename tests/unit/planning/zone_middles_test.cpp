#include "topogeo/planning/zone_middles.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "floors.hpp"

namespace topogeo::planning {
namespace {

/// The middle of the only zone of a floor with cells of 0.25 m.
Cell middle_of(const std::vector<std::string>& lines) {
  const OccupancyGrid grid = grid_of_text(lines, 0.25);
  std::vector<ZoneId> zone_of_cell;
  for (const CellState state : grid.cells())
    zone_of_cell.push_back(state == CellState::kFree ? 0 : kNoZone);
  const auto middles = middles_of_zones(grid.frame(), zone_of_cell, 2);
  EXPECT_EQ(middles.size(), 2U);
  EXPECT_FALSE(middles[1]) << "no cells";
  return middles[0].value_or(Cell{-1, -1});
}

TEST(ZoneMiddles, LieInTheMiddleOfARoom) {
  const Cell middle = middle_of({"#########",  //
                                 "#.......#",  //
                                 "#.......#",  //
                                 "#.......#",  //
                                 "#.......#",  //
                                 "#.......#",  //
                                 "#########"});
  EXPECT_EQ(middle, (Cell{4, 3}));
}

// The centroid lies beyond the inner corner; the nearest cell of the room is at its wall.
TEST(ZoneMiddles, OfARoomAroundACornerLieAwayFromWalls) {
  const Cell middle = middle_of({"#############",  //
                                 "#...........#",  //
                                 "#...........#",  //
                                 "#...........#",  //
                                 "#.....#######",  //
                                 "#.....#######",  //
                                 "#.....#######",  //
                                 "#.....#######",  //
                                 "#.....#######",  //
                                 "#############"});
  EXPECT_GE(middle.column, 2);
  EXPECT_LE(middle.column, 4);
  EXPECT_GE(middle.row, 2);
}

// A corridor around a block: the goal lies between its walls.
TEST(ZoneMiddles, OfACorridorAroundABlockLieBetweenItsWalls) {
  const Cell middle = middle_of({"###########",  //
                                 "#.........#",  //
                                 "#.........#",  //
                                 "#.........#",  //
                                 "#...###...#",  //
                                 "#...###...#",  //
                                 "#.........#",  //
                                 "#.........#",  //
                                 "#.........#",  //
                                 "###########"});
  const bool beside = middle.column == 2 || middle.column == 8;
  const bool above_or_below = middle.row == 2 || middle.row == 7;
  EXPECT_TRUE(beside || above_or_below) << middle.column << ' ' << middle.row;
}

TEST(ZoneMiddles, OfAZoneOfOneCellAreThatCell) {
  EXPECT_EQ(middle_of({"###", "#.#", "###"}), (Cell{1, 1}));
}

}  // namespace
}  // namespace topogeo::planning
