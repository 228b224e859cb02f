#include "segments.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

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

/// Polygons whose corners are on a coarse lattice, so that many touch, overlap or repeat.
TEST(Segments, SimplePolygonsAreThoseWithoutAPairOfEdgesThatMeet) {
  support::Random random(11);
  std::array<int, 2> seen{};
  for (int i = 0; i < 3000; ++i) {
    Polygon shape(3 + i % 5);
    for (Eigen::Vector2d& corner : shape) {
      corner = {std::floor(5.0 * random.uniform()), std::floor(5.0 * random.uniform())};
    }
    const std::size_t n = shape.size();
    bool simple = true;
    for (std::size_t a = 0; a < n; ++a) {
      const Eigen::Vector2d& end = shape[(a + 1) % n];
      const Eigen::Vector2d back = shape[a] - end;
      const Eigen::Vector2d ahead = shape[(a + 2) % n] - end;
      simple = simple && shape[a] != end && !(cross(back, ahead) == 0.0 && back.dot(ahead) > 0.0);
      for (std::size_t b = a + 2; b < n && (a > 0 || b + 1 < n); ++b) {
        simple = simple && !segments_meet(shape[a], end, shape[b], shape[(b + 1) % n]);
      }
    }
    ASSERT_EQ(is_simple(shape), simple) << "polygon " << i;
    ++seen.at(simple ? 1 : 0);
  }
  EXPECT_GT(seen[0], 300);
  EXPECT_GT(seen[1], 300);
}

TEST(Segments, APolygonOfManyCornersIsCheckedToo) {
  constexpr std::size_t kCorners = 60'000;
  Polygon ring(kCorners);
  for (std::size_t i = 0; i < kCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * static_cast<double>(i) / kCorners;
    ring[i] = 50.0 * Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  }
  EXPECT_TRUE(is_simple(ring));
  ring[kCorners / 2] = {60.0, 1.0};  // across the other side
  EXPECT_FALSE(is_simple(ring));
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
