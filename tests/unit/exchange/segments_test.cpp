#include "segments.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/geometry/segment.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::exchange {
namespace {

using Polygon = std::vector<Eigen::Vector2d>;

TEST(Segments, MeetAtCrossingsAndTouches) {
  EXPECT_TRUE(segments_meet({0, 0}, {2, 2}, {0, 2}, {2, 0}));
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {1, 5}));
  EXPECT_TRUE(segments_meet({0, 0}, {2, 0}, {1, 0}, {5, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {3, 0}, {5, 0}));
  EXPECT_FALSE(segments_meet({0, 0}, {2, 0}, {0, 1}, {2, 1}));
}

TEST(Segments, PolygonsAreSimpleOrNot) {
  EXPECT_TRUE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 3}}));
  EXPECT_TRUE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}));
  EXPECT_FALSE(is_simple(Polygon{{0, 0}, {4, 4}, {4, 0}, {0, 4}}));          // crosses itself
  EXPECT_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 0}, {4, 4}}));          // a repeated corner
  EXPECT_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {2, 0}, {2, 4}}));          // back on itself
  EXPECT_FALSE(is_simple(Polygon{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));  // touches itself
}

TEST(Segments, AreaTellsTheSenseOfRotation) {
  EXPECT_GT(signed_area2(Polygon{{0, 0}, {4, 0}, {4, 3}}), 0.0);
  EXPECT_LT(signed_area2(Polygon{{4, 3}, {4, 0}, {0, 0}}), 0.0);
}

TEST(Segments, OverlapIsMoreThanASharedWall) {
  const Polygon room = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  EXPECT_TRUE(polygons_overlap(room, Polygon{{3, 3}, {6, 3}, {6, 6}, {3, 6}}));
  EXPECT_TRUE(polygons_overlap(room, Polygon{{1, 1}, {2, 1}, {2, 2}}));
  EXPECT_FALSE(polygons_overlap(room, Polygon{{4, 0}, {8, 0}, {8, 4}, {4, 4}}));
  EXPECT_FALSE(polygons_overlap(room, Polygon{{5, 5}, {6, 5}, {6, 6}}));
}

TEST(Segments, TouchingAgreesWithSamplesOfTheSegment) {
  support::Random random(7);
  const auto coordinate = [&] { return 10.0 * random.uniform(); };
  const Polygon shape = {{2, 2}, {8, 3}, {7, 8}, {5, 4}, {3, 8}};
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d a(coordinate(), coordinate());
    const Eigen::Vector2d b(coordinate(), coordinate());
    bool sampled = false;
    for (int k = 0; k <= 200 && !sampled; ++k) sampled = inside(shape, a + (b - a) * (k / 200.0));
    // Samples can miss a corner that is only touched.
    const bool touches = segment_touches(shape, a, b);
    EXPECT_TRUE(touches || !sampled) << a << b;
    if (touches && !sampled) {
      bool near = false;
      for (std::size_t j = 0; j < shape.size(); ++j) {
        near =
            near || distance(geometry::nearest_on_segment(a, b, shape[j]).point_m, shape[j]) < 0.1;
      }
      EXPECT_TRUE(near) << a << b;
    }
  }
}

}  // namespace
}  // namespace topogeo::exchange
