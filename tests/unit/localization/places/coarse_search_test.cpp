// The oracle tries every pose of the window.
#include "topogeo/matching/coarse_search.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using Points = std::vector<Eigen::Vector2d>;

/// An L of two walls with a column in front: no two poses look alike.
Points room() {
  Points points_m;
  for (int i = 0; i <= 60; ++i) points_m.emplace_back(0.1 * i, 0.0);
  for (int i = 0; i <= 30; ++i) points_m.emplace_back(6.0, 0.1 * i);
  for (int i = 0; i < 10; ++i) points_m.emplace_back(2.0 + 0.05 * i, 1.5);
  return points_m;
}

/// The points as seen from a pose of the map.
Points points_seen_from(const Pose2& T_map_robot, const Points& points_m) {
  const Pose2 T_robot_map = geometry::inverse(T_map_robot);
  Points seen;
  for (const Eigen::Vector2d& p : points_m) seen.push_back(T_robot_map * p);
  return seen;
}

double score(const CoarseMap& map, const Points& points_m, const Pose2& T) {
  double sum = 0.0;
  for (const Eigen::Vector2d& p : points_m) {
    const Eigen::Vector2d q = T * p;
    sum += map.at(0, map.column(q.x()), map.row(q.y()));
  }
  return sum / (255.0 * static_cast<double>(points_m.size()));
}

TEST(CoarseMapTest, MaximaCoverTheirSquares) {
  const CoarseMap map(room());
  support::Random random(2);
  for (int level = 1; level < CoarseMap::kLevels; ++level) {
    for (int trial = 0; trial < 200; ++trial) {
      const int column = static_cast<int>(random.uniform(-20.0, 40.0));
      const int row = static_cast<int>(random.uniform(-20.0, 30.0));
      int largest = 0;
      for (int r = row; r < row + (1 << level); ++r) {
        for (int c = column; c < column + (1 << level); ++c) {
          largest = std::max(largest, static_cast<int>(map.at(0, c, r)));
        }
      }
      EXPECT_EQ(static_cast<int>(map.at(level, column, row)), largest);
    }
  }
}

TEST(CoarseMapTest, PointsOfAnImpossibleMapAreRefused) {
  const Points far{{0.0, 0.0}, {1e6, 0.0}};
  EXPECT_THROW(static_cast<void>(CoarseMap(far)), std::invalid_argument);
  EXPECT_TRUE(CoarseMap(Points{}).empty());
}

TEST(CoarseSearchTest, FindsWhereThePointsWereSeenFrom) {
  const CoarseMap map(room());
  const CoarseWindow window{{3.0, 1.0, 0.0}, {4.0, 4.0, M_PI}};
  for (const Pose2& truth : {Pose2{3.3, 1.1, 0.4}, Pose2{1.0, -1.2, -2.9}, Pose2{5.0, 2.0, 1.7}}) {
    const auto found = search_coarsely(map, points_seen_from(truth, room()), window, 0.3, 3);
    ASSERT_FALSE(found.empty());
    EXPECT_LT((found[0].T_map_points.position_m() - truth.position_m()).norm(), 0.4);
    EXPECT_LT(std::fabs(geometry::wrap_angle(found[0].T_map_points.theta_rad - truth.theta_rad)),
              0.1);
  }
}

TEST(CoarseSearchTest, MissesNothingThatTryingAllFinds) {
  const CoarseMap map(room());
  const Points points_m = points_seen_from({3.3, 1.1, 0.4}, room());
  const CoarseWindow window{{3.0, 1.0, 0.5}, {2.0, 1.5, 0.3}};
  double best = 0.0;
  for (int h = -6; h <= 6; ++h) {
    for (int y = -6; y <= 6; ++y) {
      for (int x = -8; x <= 8; ++x) {
        best = std::max(best, score(map, points_m,
                                    {3.0 + CoarseMap::kCell_m * x, 1.0 + CoarseMap::kCell_m * y,
                                     0.5 + 0.05 * h}));
      }
    }
  }
  const auto found = search_coarsely(map, points_m, window, 0.1, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].score, best, 0.02);  // the search first rounds points to cells
}

TEST(CoarseSearchTest, FindsNothingThatIsTooUnlike) {
  const CoarseMap map(room());
  const Points elsewhere{{0.0, 0.0}, {20.0, 0.0}, {0.0, 20.0}, {20.0, 20.0}};
  EXPECT_TRUE(search_coarsely(map, elsewhere, {{0.0, 0.0, 0.0}, {3.0, 3.0, 3.0}}, 0.5, 3).empty());
  EXPECT_TRUE(search_coarsely(map, {}, {{0.0, 0.0, 0.0}, {3.0, 3.0, 3.0}}, 0.5, 3).empty());
  EXPECT_TRUE(search_coarsely(map, room(), {{}, {3.0, 3.0, std::nan("")}}, 0.5, 3).empty());
}

TEST(CoarseSearchTest, BothEndsOfASymmetricCorridorAreFound) {
  Points corridor;
  for (int i = 0; i <= 80; ++i) {
    corridor.emplace_back(0.1 * i, 0.0);
    corridor.emplace_back(0.1 * i, 2.0);
  }
  const CoarseMap map(corridor);
  const auto found = search_coarsely(map, points_seen_from({4.0, 1.0, 0.0}, corridor),
                                     {{4.0, 1.0, 0.0}, {1.0, 1.0, M_PI}}, 0.5, 20);
  const auto heading = [&](double theta_rad) {
    return std::any_of(found.begin(), found.end(), [&](const CoarseMatch& match) {
      return std::fabs(geometry::wrap_angle(match.T_map_points.theta_rad - theta_rad)) < 0.1;
    });
  };
  EXPECT_TRUE(heading(0.0));
  EXPECT_TRUE(heading(M_PI));
}

}  // namespace
}  // namespace topogeo::localization
