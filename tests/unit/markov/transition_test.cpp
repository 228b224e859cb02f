#include "topogeo/markov/transition.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "drawn_map.hpp"

namespace topogeo::markov {
namespace {

std::vector<RowBits> all_free(int size) {
  std::vector<RowBits> free;
  free_cells_of_window(test::open_space(size, size), {size / 2, size / 2}, size, free);
  return free;
}

double value_at(const std::vector<Tap>& taps, Cell offset) {
  for (const Tap& tap : taps) {
    if (tap.offset == offset) return tap.probability;
  }
  return 0.0;
}

double sum_of(const std::vector<Tap>& taps) {
  double sum = 0.0;
  for (const Tap& tap : taps) sum += tap.probability;
  return sum;
}

Eigen::Vector2d mean_of(const std::vector<Tap>& taps) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Tap& tap : taps) {
    mean += tap.probability * Eigen::Vector2d{tap.offset.x, tap.offset.y};
  }
  return mean / sum_of(taps);
}

TEST(Transition, Figures4To7OfTheSource) {
  // Fig. 4: all probability in the middle. Fig. 6: the matrix of an advance. Fig. 7: the state
  // after it, in the window around the expected destination, as printed: five rows of seven.
  BeliefGrid grid{7};
  grid.set({0, 0}, 1.0);
  const double sum = spread(turned(macondo_advance(), ArrowSense::kRight, 0.0), all_free(7), grid);
  const double figure7[5][7] = {{0, 0, 0, 0, 0, 0, 0},
                                {0, 0, 0, .0625, .0078, 0, 0},
                                {0, 0, 0, .7929, .0625, 0, 0},
                                {0, 0, 0, .0625, .0078, 0, 0},
                                {0, 0, 0, 0, 0, 0, 0}};
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      EXPECT_EQ(grid.at({column - 3, 2 - row}), figure7[row][column]) << row << ", " << column;
    }
  }
  EXPECT_NEAR(sum, 0.996, 5e-4);
}

TEST(Transition, ASecondAdvanceSpreadsEveryCellOfTheFirst) {
  BeliefGrid grid{7};
  grid.set({0, 0}, 1.0);
  const std::vector<Tap> taps = turned(macondo_advance(), ArrowSense::kRight, 0.0);
  spread(taps, all_free(7), grid);
  spread(taps, all_free(7), grid);
  // The middle is reached by staying twice, or by two opposite sideways steps.
  EXPECT_NEAR(grid.at({0, 0}), .7929 * .7929 + 2 * .0625 * .0625, 1e-15);
  EXPECT_NEAR(grid.at({1, 0}), 2 * .7929 * .0625 + 4 * .0625 * .0078, 1e-15);
  EXPECT_NEAR(grid.at({2, 2}), .0078 * .0078, 1e-15);
}

TEST(Transition, QuartersTurnTheMatrixExactly) {
  // Heading up the map: cells ahead (right column) move up, cells to the left move left.
  const TransitionMatrix matrix{3, 3, {.01, .02, .03, .04, .5, .06, .07, .08, .09}};
  const std::vector<Tap> up = turned(matrix, ArrowSense::kRight, test::kQuarter_rad);
  EXPECT_EQ(value_at(up, {0, 1}), .06);
  EXPECT_EQ(value_at(up, {-1, 0}), .02);
  EXPECT_EQ(value_at(up, {-1, 1}), .03);
  EXPECT_EQ(value_at(up, {1, -1}), .07);
  const std::vector<Tap> back = turned(matrix, ArrowSense::kRight, std::numbers::pi);
  EXPECT_EQ(value_at(back, {-1, 0}), .06);
  EXPECT_EQ(value_at(back, {0, -1}), .02);
  const std::vector<Tap> down = turned(matrix, ArrowSense::kRight, -test::kQuarter_rad);
  EXPECT_EQ(value_at(down, {0, -1}), .06);
  EXPECT_EQ(value_at(down, {1, 0}), .02);
  const std::vector<Tap> around = turned(matrix, ArrowSense::kRight, 4 * test::kQuarter_rad);
  EXPECT_EQ(value_at(around, {1, 0}), .06);
  EXPECT_EQ(around.size(), 9U);
}

TEST(Transition, TheArrowMayPointBack) {
  const std::vector<Tap> taps = turned(macondo_advance(), ArrowSense::kLeft, 0.0);
  EXPECT_EQ(value_at(taps, {-1, 0}), .0625);
  EXPECT_EQ(value_at(taps, {1, 0}), 0.0);
  EXPECT_EQ(value_at(taps, {0, 0}), .7929);
  // Cells to the left of the robot stay on its left.
  const TransitionMatrix leftward{3, 1, {.3, .6, .1}};
  EXPECT_EQ(value_at(turned(leftward, ArrowSense::kLeft, 0.0), {0, 1}), .3);
}

TEST(Transition, OtherAnglesKeepSumAndMean) {
  const TransitionMatrix matrix{
      3, 5, {0, .01, .02, .03, .01, .05, .1, .5, .12, .03, 0, .02, .04, .02, .01}};
  const std::vector<Tap> straight = turned(matrix, ArrowSense::kRight, 0.0);
  const Eigen::Vector2d mean = mean_of(straight);
  for (int degrees = -720; degrees <= 720; degrees += 7) {
    const double heading_rad = degrees * std::numbers::pi / 180.0;
    const std::vector<Tap> taps = turned(matrix, ArrowSense::kRight, heading_rad);
    EXPECT_NEAR(sum_of(taps), sum_of(straight), 1e-14) << degrees;
    const double c = std::cos(heading_rad);
    const double s = std::sin(heading_rad);
    EXPECT_NEAR(mean_of(taps).x(), c * mean.x() - s * mean.y(), 1e-12) << degrees;
    EXPECT_NEAR(mean_of(taps).y(), s * mean.x() + c * mean.y(), 1e-12) << degrees;
    for (const Tap& tap : taps) EXPECT_GT(tap.probability, 0.0);
  }
}

TEST(Transition, AtHalfARightAngleAValueIsSharedAmongFour) {
  // One cell ahead at 45 degrees: (0.7071, 0.7071).
  const TransitionMatrix ahead{1, 3, {0, 0, 1}};
  const std::vector<Tap> taps = turned(ahead, ArrowSense::kRight, 0.5 * test::kQuarter_rad);
  const double part = std::numbers::sqrt2 / 2.0;
  EXPECT_NEAR(value_at(taps, {1, 1}), part * part, 1e-12);
  EXPECT_NEAR(value_at(taps, {1, 0}), part * (1 - part), 1e-12);
  EXPECT_NEAR(value_at(taps, {0, 1}), part * (1 - part), 1e-12);
  EXPECT_NEAR(value_at(taps, {0, 0}), (1 - part) * (1 - part), 1e-12);
}

TEST(Transition, ObstaclesTakeNothingAndGiveNothing) {
  // The cell ahead of the robot is an obstacle, and so is a cell that it cannot have come from.
  const ObstacleCells map = test::drawn({".....",  //
                                         ".....",  //
                                         "...#.",  //
                                         ".....",  //
                                         "....."});
  std::vector<RowBits> free;
  free_cells_of_window(map, {2, 2}, 5, free);
  BeliefGrid grid{5};
  grid.set({0, 0}, 1.0);
  const double sum = spread(turned(macondo_advance(), ArrowSense::kRight, 0.0), free, grid);
  EXPECT_EQ(grid.at({1, 0}), 0.0);
  EXPECT_EQ(grid.at({1, 1}), .0078);
  EXPECT_NEAR(sum, .7929 + 2 * .0625 + 2 * .0078, 1e-15);
}

/// The rule of MACONDO, cell by cell: cells with zero contribute nothing; each other cell adds its
/// probability times every value of the matrix at the target cells.
std::vector<double> cell_by_cell(const BeliefGrid& grid, const std::vector<Tap>& taps,
                                 const ObstacleCells& map) {
  const int half = grid.half();
  const std::ptrdiff_t side = grid.size();
  std::vector<double> result(grid.current().size(), 0.0);
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      if (grid.at({x, y}) == 0.0) continue;
      for (const Tap& tap : taps) {
        const Cell to{x + tap.offset.x, y + tap.offset.y};
        if (std::abs(to.x) > half || std::abs(to.y) > half) continue;
        if (!map.free({grid.centre().x + to.x, grid.centre().y + to.y})) continue;
        result[static_cast<std::size_t>((to.y + half) * side + to.x + half)] +=
            tap.probability * grid.at({x, y});
      }
    }
  }
  return result;
}

TEST(Transition, TheUpdateEqualsTheRuleCellByCell) {
  std::mt19937 random{11};
  std::uniform_real_distribution<double> uniform{0.0, 1.0};
  const TransitionMatrix wide{5, 7, std::vector<double>(35, 1.0 / 35.0)};
  for (int run = 0; run < 60; ++run) {
    std::vector<std::uint8_t> cells(std::size_t{40} * 40);
    for (std::uint8_t& cell : cells) cell = uniform(random) < 0.2 ? 1 : 0;
    const ObstacleCells map{{.width = 40, .height = 40, .resolution_m = 0.1, .occupied = cells}};
    BeliefGrid grid{run % 2 == 0 ? 21 : 7};
    grid.carry_to({run % 40, (run * 7) % 40});  // also over the border of the map
    std::vector<RowBits> free;
    free_cells_of_window(map, grid.centre(), grid.size(), free);
    for (double& probability : grid.current()) probability = uniform(random);
    grid.keep_only(free);
    const double heading_rad = 0.4 * run;
    const std::vector<Tap> taps =
        turned(run % 3 == 0 ? wide : macondo_advance(), ArrowSense::kRight, heading_rad);
    const std::vector<double> expected = cell_by_cell(grid, taps, map);
    const double sum = spread(taps, free, grid);
    double expected_sum = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_NEAR(grid.current()[i], expected[i], 1e-12) << "run " << run << ", cell " << i;
      expected_sum += expected[i];
    }
    EXPECT_NEAR(sum, expected_sum, 1e-9);
  }
}

TEST(Transition, APartOfAStepSpreadsThatPart) {
  const std::vector<Tap> taps = turned(macondo_advance(), ArrowSense::kRight, 0.0);
  BeliefGrid grid{5};
  grid.set({0, 0}, 1.0);
  spread(part_of(taps, 0.25), all_free(5), grid);
  EXPECT_NEAR(grid.at({0, 0}), 0.75 + 0.25 * .7929, 1e-15);
  EXPECT_NEAR(grid.at({1, 0}), 0.25 * .0625, 1e-15);
  EXPECT_EQ(part_of(taps, 1.0).size(), taps.size());
}

TEST(Transition, ModelsOutOfRangeAreRefused) {
  EXPECT_NO_THROW(check(TransitionModel{}));
  const auto refused = [](const TransitionMatrix& matrix) {
    TransitionModel model;
    model.right = matrix;
    EXPECT_THROW(check(model), std::invalid_argument);
  };
  refused({2, 3, std::vector<double>(6, 0.1)});
  refused({3, 23, std::vector<double>(69, 0.01)});
  refused({3, 3, {1.0}});
  refused({1, 3, {-0.1, 0.9, 0.1}});
  refused({1, 1, {std::numeric_limits<double>::quiet_NaN()}});
  refused({1, 3, {0.0, 0.0, 0.0}});
  refused({1, 3, {0.5, 0.5, 0.5}});
  TransitionModel model;
  model.advance_step_m = -0.1;
  EXPECT_THROW(check(model), std::invalid_argument);
  model.advance_step_m = 0.0;
  EXPECT_NO_THROW(check(model));
  model.turn_step_rad = std::numeric_limits<double>::infinity();
  EXPECT_THROW(check(model), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::markov
