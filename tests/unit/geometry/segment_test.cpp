#include "topogeo/geometry/segment.hpp"

#include <gtest/gtest.h>

namespace topogeo::geometry {
namespace {

TEST(Segment, NearestPlaceLiesWithinIt) {
  const Eigen::Vector2d a_m(1.0, 1.0);
  const Eigen::Vector2d b_m(5.0, 1.0);
  const auto expect = [&](const Eigen::Vector2d& point_m, double x_m, double share) {
    const SegmentPlace place = nearest_on_segment(a_m, b_m, point_m);
    EXPECT_EQ(place.point_m, Eigen::Vector2d(x_m, 1.0));
    EXPECT_EQ(place.share, share);
  };
  expect({2.0, 7.0}, 2.0, 0.25);
  expect({-3.0, 0.0}, 1.0, 0.0);
  expect({9.0, -2.0}, 5.0, 1.0);
  EXPECT_EQ(nearest_on_segment(a_m, a_m, b_m).point_m, a_m) << "without length";
}

}  // namespace
}  // namespace topogeo::geometry
