#include "topogeo/geometry/footprint.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

const Footprint kRectangle{{{0.6, 0.3}, {0.6, -0.3}, {-0.6, -0.3}, {-0.6, 0.3}}};

TEST(Footprint, DistancesOfARectangle) {
  EXPECT_NEAR(signed_distance_m(kRectangle, {0.0, 0.0}), -0.3, 1e-12);
  EXPECT_NEAR(signed_distance_m(kRectangle, {0.5, 0.1}), -0.1, 1e-12);
  EXPECT_NEAR(signed_distance_m(kRectangle, {1.0, 0.0}), 0.4, 1e-12);
  EXPECT_NEAR(signed_distance_m(kRectangle, {0.9, -0.7}), 0.5, 1e-12);
  EXPECT_NEAR(inscribed_radius_m(kRectangle), 0.3, 1e-12);
  EXPECT_NEAR(circumscribed_radius_m(kRectangle), std::hypot(0.6, 0.3), 1e-12);
}

TEST(Footprint, ANotchIsOutside) {
  const Footprint fork{{{0.5, 0.4},
                        {0.5, 0.2},
                        {0.1, 0.2},
                        {0.1, -0.2},
                        {0.5, -0.2},
                        {0.5, -0.4},
                        {-0.5, -0.4},
                        {-0.5, 0.4}}};
  EXPECT_EQ(fault_of(fork), "");
  EXPECT_NEAR(signed_distance_m(fork, {0.3, 0.0}), 0.2, 1e-12);
  EXPECT_NEAR(inscribed_radius_m(fork), 0.1, 1e-12);
}

TEST(Footprint, PointsCoverTheBody) {
  constexpr double kSpacing_m = 0.15;
  const auto points_m = covering_points_m(kRectangle, kSpacing_m);
  for (double x_m = -0.6; x_m <= 0.6; x_m += 0.02) {
    for (double y_m = -0.3; y_m <= 0.3; y_m += 0.02) {
      double least_m = 1.0;
      for (const auto& point_m : points_m) {
        EXPECT_LE(signed_distance_m(kRectangle, point_m), 1e-9);
        least_m = std::min(least_m, (point_m - Eigen::Vector2d(x_m, y_m)).norm());
      }
      ASSERT_LE(least_m, kSpacing_m) << x_m << ", " << y_m;
    }
  }
}

TEST(Footprint, FaultsAreNamed) {
  EXPECT_EQ(fault_of({}), "");
  EXPECT_EQ(fault_of(kRectangle), "");
  EXPECT_NE(fault_of({{{1.0, 0.0}, {-1.0, 0.0}}}).find("2 corners"), std::string::npos);
  EXPECT_NE(fault_of({{{0.6, 0.3}, {-0.6, -0.3}, {0.6, -0.3}, {-0.6, 0.3}}}).find("touch"),
            std::string::npos);
  EXPECT_NE(fault_of({{{1.6, 0.3}, {1.6, -0.3}, {0.4, -0.3}, {0.4, 0.3}}}).find("origin"),
            std::string::npos);
  EXPECT_NE(fault_of({{{600.0, 300.0}, {600.0, -300.0}, {-600.0, 0.0}}}).find("3 m"),
            std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(fault_of({{{nan, 0.3}, {0.6, -0.3}, {-0.6, 0.0}}}), "");
}

}  // namespace
}  // namespace topogeo::geometry
