#include "topogeo/voronoi/distance_error.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::voronoi {
namespace {

TEST(DistanceError, Table1OfChapter4) {
  struct Row {
    double resolution_cm;
    double e_max_cm;
    double twice_e_max_cm;
  };
  // The Thesis prints 3.53 for 5 cm, which is 3.5355 truncated instead of rounded.
  for (const Row& row : {Row{1, 0.71, 1.41}, Row{3, 2.12, 4.24}, Row{5, 3.535, 7.07},
                         Row{7, 4.95, 9.9}, Row{9, 6.36, 12.73}}) {
    const double e_max_cm = 100.0 * largest_distance_error_m(0.01 * row.resolution_cm);
    EXPECT_NEAR(e_max_cm, row.e_max_cm, 0.005) << row.resolution_cm << " cm";
    EXPECT_NEAR(2.0 * e_max_cm, row.twice_e_max_cm, 0.005) << row.resolution_cm << " cm";
  }
}

TEST(DistanceError, ACellWithoutASideIsRefused) {
  EXPECT_THROW(largest_distance_error_m(0.0), std::invalid_argument);
  EXPECT_THROW(largest_distance_error_m(-0.05), std::invalid_argument);
  EXPECT_THROW(largest_distance_error_m(std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
  EXPECT_THROW(largest_distance_error_m(std::numeric_limits<double>::infinity()),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::voronoi
