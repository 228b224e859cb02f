#include "topogeo/matching/nearest_point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

struct Resolution {
  double cell_m;
  double reach_m;
};

std::ostream& operator<<(std::ostream& out, const Resolution& resolution) {
  return out << resolution.cell_m << " m cells, " << resolution.reach_m << " m reach";
}

class NearestPointGridTest : public testing::TestWithParam<Resolution> {};

std::vector<Eigen::Vector2d> random_points(std::size_t count, support::Random& random) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    points.emplace_back(random.uniform(-4.0, 4.0), random.uniform(-3.0, 5.0));
  }
  return points;
}

TEST_P(NearestPointGridTest, IsNearlyAsGoodAsComparingWithEveryPoint) {
  const auto [cell_m, reach_m] = GetParam();
  support::Random random(3);
  const std::vector<Eigen::Vector2d> points = random_points(250, random);
  NearestPointGrid grid;
  grid.build(points, cell_m, reach_m);
  int near = 0;
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector2d place(random.uniform(-6.0, 6.0), random.uniform(-5.0, 7.0));
    double nearest_m = std::numeric_limits<double>::max();
    for (const auto& p : points) nearest_m = std::min(nearest_m, (p - place).norm());
    const std::int32_t found = grid.find(place.x(), place.y());
    if (nearest_m <= reach_m) {
      ++near;
      ASSERT_NE(found, NearestPointGrid::kNone) << place.transpose() << ": " << nearest_m;
      // The point nearest to the centre of the cell, which is at most half a diagonal away.
      const double found_m = (points[static_cast<std::size_t>(found)] - place).norm();
      ASSERT_LE(found_m, nearest_m + std::numbers::sqrt2 * cell_m + 1e-9) << place.transpose();
    }
    if (nearest_m > std::numbers::sqrt2 * (reach_m + 2.0 * cell_m)) {
      ++far;
      ASSERT_EQ(found, NearestPointGrid::kNone) << place.transpose() << ": " << nearest_m;
    }
  }
  EXPECT_GT(near, 500);
  EXPECT_GT(far, 500);
}

INSTANTIATE_TEST_SUITE_P(Resolutions, NearestPointGridTest,
                         testing::Values(Resolution{0.10, 0.60}, Resolution{0.10, 0.25},
                                         Resolution{0.30, 0.30}, Resolution{0.07, 0.50}),
                         [](const auto& resolution) {
                           return "cell" +
                                  std::to_string(std::lround(100 * resolution.param.cell_m)) +
                                  "reach" +
                                  std::to_string(std::lround(100 * resolution.param.reach_m));
                         });

TEST_P(NearestPointGridTest, EachCellHasThePointNearestToItsCentre) {
  const auto [cell_m, reach_m] = GetParam();
  support::Random random(7);
  const std::vector<Eigen::Vector2d> points = random_points(150, random);
  NearestPointGrid grid;
  grid.build(points, cell_m, reach_m);
  Eigen::Vector2d low = points.front();
  for (const auto& p : points) low = low.cwiseMin(p);
  const double margin_m = (std::ceil(reach_m / cell_m) + 2.0) * cell_m;
  const Eigen::Vector2d first_centre = low.array() - margin_m + 0.5 * cell_m;
  const int cells = static_cast<int>((8.0 + 2.0 * margin_m) / cell_m);
  const double slack_m = 1e-4 * cell_m;  // for single precision
  int with_point = 0;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const Eigen::Vector2d centre = first_centre + cell_m * Eigen::Vector2d(column, row);
      double nearest_m = std::numeric_limits<double>::max();
      for (const auto& p : points) nearest_m = std::min(nearest_m, (p - centre).norm());
      const std::int32_t found = grid.find(centre.x(), centre.y());
      // Points farther away are found only in the corners of the square around them.
      if (nearest_m > reach_m) continue;
      ASSERT_NE(found, NearestPointGrid::kNone) << centre.transpose();
      ++with_point;
      ASSERT_LE((points[static_cast<std::size_t>(found)] - centre).norm(), nearest_m + slack_m)
          << centre.transpose();
    }
  }
  EXPECT_GT(with_point, 200);
}

// Single precision may put a place on a border into the neighbouring cell.
TEST_P(NearestPointGridTest, FourAtOnceAreTheSame) {
  const auto [cell_m, reach_m] = GetParam();
  support::Random random(5);
  const std::vector<Eigen::Vector2d> points = random_points(100, random);
  NearestPointGrid grid;
  grid.build(points, cell_m, reach_m);
  int different = 0;
  for (int i = 0; i < 5000; ++i) {
    Eigen::Array4f x;
    Eigen::Array4f y;
    for (Eigen::Index k = 0; k < 4; ++k) {
      x[k] = static_cast<float>(random.uniform(-7.0, 7.0));
      y[k] = static_cast<float>(random.uniform(-6.0, 8.0));
    }
    const auto found = grid.find_four(x, y);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      const std::int32_t one = grid.find(static_cast<double>(x[at]), static_cast<double>(y[at]));
      const std::int32_t four =
          found[k] == points.size() ? NearestPointGrid::kNone : static_cast<std::int32_t>(found[k]);
      different += one != four ? 1 : 0;
    }
  }
  EXPECT_LE(different, 5);
}

TEST(NearestPointGridEdgeTest, FindsNothingWithoutPointsOrFarAway) {
  NearestPointGrid grid;
  EXPECT_EQ(grid.find(0.0, 0.0), NearestPointGrid::kNone);
  grid.build({{1.0, 1.0}}, 0.1, 0.5);
  EXPECT_EQ(grid.find(1.0, 1.0), 0);
  EXPECT_EQ(grid.find(1.0, 3.0), NearestPointGrid::kNone);
  EXPECT_EQ(grid.find(-1e9, 1e9), NearestPointGrid::kNone);
  EXPECT_EQ(grid.find(std::numeric_limits<double>::quiet_NaN(), 1.0), NearestPointGrid::kNone);
}

TEST(NearestPointGridEdgeTest, FourPlacesFarOutsideFindNothing) {
  NearestPointGrid grid;
  const Eigen::Array4f x(0.0F, -1e9F, 1e9F, 3.0F);
  const Eigen::Array4f y(0.0F, 1e9F, -1e9F, 1e8F);
  for (const std::size_t found : grid.find_four(x, y)) EXPECT_EQ(found, 0U);
  grid.build({{1.0, 1.0}, {1.0, 1.1}}, 0.1, 0.5);
  for (const std::size_t found : grid.find_four(x, y)) EXPECT_EQ(found, 2U);
  EXPECT_EQ(grid.find_four(Eigen::Array4f::Constant(1.0F), Eigen::Array4f::Constant(1.0F))[2], 0U);
}

TEST(NearestPointGridEdgeTest, RefusesWhatMakesNoGrid) {
  NearestPointGrid grid;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(grid.build({{0.0, 0.0}, {1e6, 1e6}}, 0.1, 0.5), std::invalid_argument);
  EXPECT_THROW(grid.build({{0.0, 0.0}, {1e300, 0.0}}, 0.1, 0.5), std::invalid_argument);
  EXPECT_THROW(grid.build({{nan, 0.0}, {0.0, 1.0}}, 0.1, 0.5), std::invalid_argument);
  EXPECT_THROW(grid.build(std::vector<Eigen::Vector2d>(65535, {0.0, 0.0}), 0.1, 0.5),
               std::invalid_argument);
}

TEST(NearestPointGridEdgeTest, BuildingAgainForgetsTheOldPoints) {
  NearestPointGrid grid;
  grid.build({{0.0, 0.0}, {5.0, 5.0}}, 0.1, 0.5);
  grid.build({{2.0, 2.0}}, 0.1, 0.5);
  EXPECT_EQ(grid.find(2.1, 2.0), 0);
  EXPECT_EQ(grid.find(0.0, 0.0), NearestPointGrid::kNone);
  grid.build({}, 0.1, 0.5);
  EXPECT_EQ(grid.find(2.1, 2.0), NearestPointGrid::kNone);
}

}  // namespace
}  // namespace topogeo::localization
