// The value of unknown floor.
#include "unknown_floor.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "planning/floors.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kCell_m = 0.25;

UnknownFloor unknown_of(const std::vector<std::string>& lines) {
  planning::InflationConfig inflation;
  inflation.forbidden_cells = 1.0;
  return UnknownFloor(planning::FreeSpace(planning::grid_of_text(lines, kCell_m), inflation));
}

Eigen::Vector2d at(int column, int row) {
  return {kCell_m * (column + 0.5), kCell_m * (row + 0.5)};
}

TEST(UnknownFloor, IsWhatTheRobotCouldDriveInto) {
  const UnknownFloor floor = unknown_of({
      "##########",
      "#...????##",
      "#...????##",
      "#...????##",
      "#...????##",
      "##########",
  });
  EXPECT_TRUE(floor.contains({5, 2}));
  EXPECT_FALSE(floor.contains({5, 1}));  // beside the wall
  EXPECT_FALSE(floor.contains({2, 2}));  // known
  EXPECT_FALSE(floor.contains({20, 2}));
  EXPECT_TRUE(floor.beside({3, 2}));
  EXPECT_FALSE(floor.beside({2, 2}));
}

TEST(UnknownFloor, IsCountedAsFarAsItLiesStraightAheadAndInSight) {
  const std::vector<std::string> lines(41, std::string(41, '?'));
  const UnknownFloor open = unknown_of(lines);
  // A whole disc.
  EXPECT_NEAR(open.ahead_m2(at(20, 20), 0.5, 2.0), 3.1416 * 4.0, 0.7);
  std::vector<std::string> half = lines;
  for (std::string& line : half) std::fill_n(line.begin(), 20, '.');
  EXPECT_NEAR(unknown_of(half).ahead_m2(at(19, 20), 0.5, 2.0), 3.1416 * 2.0, 0.9);
  // The unknown area begins too far away, or an obstacle is in between.
  EXPECT_EQ(unknown_of(half).ahead_m2(at(15, 20), 0.5, 2.0), 0.0);
  for (std::string& line : half) line[18] = '#';
  EXPECT_EQ(unknown_of(half).ahead_m2(at(15, 20), 1.5, 2.0), 0.0);
}

TEST(UnknownFloor, IsNotSeenThroughASmallHole) {
  std::vector<std::string> lines(21, std::string(8, '.') + "#" + std::string(12, '?'));
  lines[10][8] = '?';
  EXPECT_EQ(unknown_of(lines).ahead_m2(at(7, 10), 1.0, 3.0), 0.0);
  for (int line = 8; line <= 12; ++line) lines[static_cast<std::size_t>(line)][8] = '?';
  EXPECT_GT(unknown_of(lines).ahead_m2(at(7, 10), 1.0, 3.0), 0.5);
}

}  // namespace
}  // namespace topogeo::navigation
