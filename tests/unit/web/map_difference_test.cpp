#include "history/map_difference.hpp"

#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace topogeo::web {
namespace {

using planning::Cell;
using planning::CellState;
using planning::GridFrame;
using planning::OccupancyGrid;

/// '#' occupied, '.' free, ' ' unknown; the first line is the top row.
OccupancyGrid drawn(const std::vector<std::string>& lines, double x_m = 0.0, double y_m = 0.0) {
  GridFrame frame;
  frame.columns = static_cast<std::int32_t>(lines.front().size());
  frame.rows = static_cast<std::int32_t>(lines.size());
  frame.resolution_m = 0.5;
  frame.T_map_grid = {x_m, y_m, 0.0};
  OccupancyGrid grid(frame);
  for (std::int32_t row = 0; row < frame.rows; ++row) {
    const std::string& line = lines[lines.size() - 1 - static_cast<std::size_t>(row)];
    for (std::int32_t column = 0; column < frame.columns; ++column) {
      const char sign = line[static_cast<std::size_t>(column)];
      const CellState state = sign == '#'   ? CellState::kOccupied
                              : sign == '.' ? CellState::kFree
                                            : CellState::kUnknown;
      grid.set({column, row}, state);
    }
  }
  return grid;
}

CellChange at(const MapDifference& difference, double x_m, double y_m) {
  return difference.cells[difference.frame.index(*difference.frame.cell_of({x_m, y_m}))];
}

double area_m2(const MapDifference& difference, CellChange change) {
  return difference.areas_m2.at(static_cast<std::size_t>(change));
}

TEST(MapDifference, NamesWhatIsGoneNewSeenAndLost) {
  const OccupancyGrid before = drawn({"#......", "......."});
  const OccupancyGrid after = drawn({"......#", "......."}, 0.5, 0.0);  // a cell further right

  const MapDifference made = difference(before, after);

  EXPECT_EQ(at(made, 0.25, 0.75), CellChange::kLost);  // to the left of the second grid
  EXPECT_EQ(at(made, 0.25, 0.25), CellChange::kLost);
  EXPECT_EQ(at(made, 3.75, 0.75), CellChange::kSeen);  // to the right of the first
  EXPECT_EQ(at(made, 1.25, 0.25), CellChange::kSame);
  EXPECT_DOUBLE_EQ(area_m2(made, CellChange::kLost), 0.5);
  EXPECT_DOUBLE_EQ(area_m2(made, CellChange::kSeen), 0.5);
  EXPECT_DOUBLE_EQ(area_m2(made, CellChange::kGone), 0.0);
}

TEST(MapDifference, AWallThatMovedByACellIsTheSame) {
  const OccupancyGrid before = drawn({"..#....", "..#....", "..#...."});
  const MapDifference one = difference(before, drawn({"...#...", "...#...", "...#..."}));
  EXPECT_DOUBLE_EQ(area_m2(one, CellChange::kGone), 0.0);
  EXPECT_DOUBLE_EQ(area_m2(one, CellChange::kNew), 0.0);

  const MapDifference two = difference(before, drawn({"....#..", "....#..", "....#.."}));
  EXPECT_EQ(at(two, 1.25, 0.75), CellChange::kGone);
  EXPECT_EQ(at(two, 2.25, 0.75), CellChange::kNew);
  EXPECT_DOUBLE_EQ(area_m2(two, CellChange::kGone), 0.75);
  EXPECT_DOUBLE_EQ(area_m2(two, CellChange::kNew), 0.75);
}

TEST(MapDifference, IsTheSameWithTheVersionsExchanged) {
  const OccupancyGrid a = drawn({"#.. ..#", ".#. ...", "... #.."});
  const OccupancyGrid b = drawn({"....#..", "#.. ...", ".... .."});
  const MapDifference forth = difference(a, b);
  const MapDifference back = difference(b, a);
  EXPECT_EQ(area_m2(forth, CellChange::kGone), area_m2(back, CellChange::kNew));
  EXPECT_EQ(area_m2(forth, CellChange::kNew), area_m2(back, CellChange::kGone));
  EXPECT_EQ(area_m2(forth, CellChange::kSeen), area_m2(back, CellChange::kLost));
  EXPECT_EQ(area_m2(forth, CellChange::kLost), area_m2(back, CellChange::kSeen));
  EXPECT_TRUE(difference_png(forth).starts_with("\x89PNG"));
}

TEST(MapDifference, RefusesMapsThatLieFarApart) {
  EXPECT_THROW(difference(drawn({"."}), drawn({"."}, 1e5, 1e5)), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::web
