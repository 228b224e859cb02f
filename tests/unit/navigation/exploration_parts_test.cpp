// Parts of the exploration that have no public header: the value of unknown floor and the order of
// places.
#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

#include "planning/floors.hpp"
#include "short_tour.hpp"
#include "unknown_floor.hpp"

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
  // It begins too far away, or something is between.
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

/// Places on a line, or anywhere.
WayTable ways_of(double start, const std::vector<double>& places) {
  WayTable ways_m(places.size());
  for (std::size_t a = 0; a < places.size(); ++a) {
    ways_m.from_start(a) = std::abs(places[a] - start);
    for (std::size_t b = a + 1; b < places.size(); ++b) {
      ways_m.between(a, b) = std::abs(places[a] - places[b]);
    }
  }
  return ways_m;
}

TEST(ShortTour, DoesNotLeaveOnePlaceBehind) {
  // Going on to the nearest: 1.0, 4, 9, then back to -1.1; 19.1 m. The short one takes 11.2 m.
  const WayTable ways_m = ways_of(0.0, {1.0, 4.0, 9.0, -1.1});
  const std::vector<std::size_t> order = short_tour(ways_m);
  EXPECT_EQ(order, (std::vector<std::size_t>{3, 0, 1, 2}));
  EXPECT_NEAR(length_m(ways_m, order), 1.1 + 10.1, 1e-12);
}

TEST(ShortTour, OfNothingIsEmpty) {
  EXPECT_TRUE(short_tour(WayTable(0)).empty());
  EXPECT_EQ(short_tour(ways_of(0.0, {3.0})), std::vector<std::size_t>{0});
}

TEST(ShortTour, IsNearlyAsShortAsTheShortestOfAll) {
  support::Random random(7);
  double sum_m = 0.0;
  double least_sum_m = 0.0;
  for (int round = 0; round < 40; ++round) {
    std::vector<Eigen::Vector2d> places_m(7);
    for (Eigen::Vector2d& place_m : places_m) {
      place_m = {random.uniform(0.0, 30.0), random.uniform(0.0, 30.0)};
    }
    WayTable ways_m(places_m.size());
    for (std::size_t a = 0; a < places_m.size(); ++a) {
      ways_m.from_start(a) = places_m[a].norm();
      for (std::size_t b = a + 1; b < places_m.size(); ++b) {
        ways_m.between(b, a) = (places_m[a] - places_m[b]).norm();
      }
    }
    std::vector<std::size_t> order(places_m.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    double least_m = length_m(ways_m, order);
    while (std::next_permutation(order.begin(), order.end())) {
      least_m = std::min(least_m, length_m(ways_m, order));
    }
    const std::vector<std::size_t> found = short_tour(ways_m);
    EXPECT_TRUE(std::is_permutation(found.begin(), found.end(), order.begin(), order.end()));
    EXPECT_GE(length_m(ways_m, found), least_m - 1e-9);
    EXPECT_LE(length_m(ways_m, found), 1.25 * least_m);
    sum_m += length_m(ways_m, found);
    least_sum_m += least_m;
  }
  EXPECT_LE(sum_m, 1.03 * least_sum_m);
}

}  // namespace
}  // namespace topogeo::navigation
