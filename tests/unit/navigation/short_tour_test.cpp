// The order of places.
#include "short_tour.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

/// Distances between places on a line, or between any places.
DistanceTable distances_of(double start, const std::vector<double>& places) {
  DistanceTable distances_m(places.size());
  for (std::size_t a = 0; a < places.size(); ++a) {
    distances_m.from_start(a) = std::abs(places[a] - start);
    for (std::size_t b = a + 1; b < places.size(); ++b) {
      distances_m.between(a, b) = std::abs(places[a] - places[b]);
    }
  }
  return distances_m;
}

TEST(ShortTour, DoesNotLeaveOnePlaceBehind) {
  // Nearest first: 1.0, 4, 9, then back to -1.1; 19.1 m. The short tour takes 11.2 m.
  const DistanceTable distances_m = distances_of(0.0, {1.0, 4.0, 9.0, -1.1});
  const std::vector<std::size_t> order = short_tour(distances_m);
  EXPECT_EQ(order, (std::vector<std::size_t>{3, 0, 1, 2}));
  EXPECT_NEAR(length_m(distances_m, order), 1.1 + 10.1, 1e-12);
}

TEST(ShortTour, OfNothingIsEmpty) {
  EXPECT_TRUE(short_tour(DistanceTable(0)).empty());
  EXPECT_EQ(short_tour(distances_of(0.0, {3.0})), std::vector<std::size_t>{0});
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
    DistanceTable distances_m(places_m.size());
    for (std::size_t a = 0; a < places_m.size(); ++a) {
      distances_m.from_start(a) = places_m[a].norm();
      for (std::size_t b = a + 1; b < places_m.size(); ++b) {
        distances_m.between(b, a) = (places_m[a] - places_m[b]).norm();
      }
    }
    std::vector<std::size_t> order(places_m.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    double least_m = length_m(distances_m, order);
    while (std::next_permutation(order.begin(), order.end())) {
      least_m = std::min(least_m, length_m(distances_m, order));
    }
    const std::vector<std::size_t> found = short_tour(distances_m);
    EXPECT_TRUE(std::is_permutation(found.begin(), found.end(), order.begin(), order.end()));
    EXPECT_GE(length_m(distances_m, found), least_m - 1e-9);
    EXPECT_LE(length_m(distances_m, found), 1.25 * least_m);
    sum_m += length_m(distances_m, found);
    least_sum_m += least_m;
  }
  EXPECT_LE(sum_m, 1.03 * least_sum_m);
}

}  // namespace
}  // namespace topogeo::navigation
