// Edges of walls, found from the features of a scan.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/support/random.hpp"

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

constexpr double kDoorFrom_m = 2.0;
constexpr double kDoorTo_m = 2.9;

// Edges measured by a laser with centimetres of noise; in the frame of the robot.
std::vector<WallEdge> noisy_edges(const world::World& world, const Pose2& T_world_robot,
                                  support::Random& random) {
  constexpr double kNoise_m = 0.02;
  constexpr double kMostNoise_m = 0.05;
  std::vector<topomap::ScanPoint> points = test::exact_points(world, T_world_robot);
  for (topomap::ScanPoint& p : points) {
    const double range_m = std::hypot(p.x_m, p.y_m);
    const double error_m = std::clamp(kNoise_m * random.normal(), -kMostNoise_m, kMostNoise_m);
    const auto factor = static_cast<float>(1.0 + error_m / range_m);
    p = {p.x_m * factor, p.y_m * factor};
  }
  return extract_scan_features(points, {}).edges;
}

TEST(WallEdgesTest, ArePutWhereTheDoorIsFromBothSides) {
  // Errors along the corridor by the edge and by the side of the viewer.
  std::array<std::array<std::vector<double>, 2>, 2> errors_m;
  support::Random random(7);
  for (double x_m = -1.0; x_m <= 6.0; x_m += 0.02) {
    const Pose2 T{x_m, 0.1, 0.3};
    const geometry::SinCos heading = geometry::sincos(T.theta_rad);
    for (const WallEdge& in_robot : noisy_edges(test::corridor_with_shut_door(), T, random)) {
      const WallEdge edge = moved(in_robot, T, heading);
      const bool first = edge.direction.x() > 0.0;  // the door is to its right
      const double error_m = edge.position_m.x() - (first ? kDoorFrom_m : kDoorTo_m);
      EXPECT_LT(std::fabs(error_m), 0.25) << "seen from x = " << x_m;
      EXPECT_NEAR(edge.position_m.y(), 1.0, 0.03);
      EXPECT_NEAR(edge.step_m, 0.08, 0.035);
      errors_m.at(first ? 0 : 1).at(x_m < edge.position_m.x() ? 0 : 1).push_back(error_m);
    }
  }
  for (const auto& sides : errors_m) {
    for (const std::vector<double>& errors : sides) {
      ASSERT_GT(errors.size(), 60U);
      double sum_m = 0.0;
      double squares_m2 = 0.0;
      for (const double error_m : errors) {
        sum_m += error_m;
        squares_m2 += error_m * error_m;
      }
      const auto count = static_cast<double>(errors.size());
      // An edge that moves with the robot would shorten the map.
      EXPECT_LT(std::fabs(sum_m / count), 0.006);
      EXPECT_LT(std::sqrt(squares_m2 / count), 0.03);
    }
  }
}

TEST(WallEdgesTest, APlainWallHasNone) {
  support::Random random(11);
  std::size_t found = 0;
  for (int i = 0; i < 300; ++i) {
    found += noisy_edges(test::endless_corridor(), {0.0, 0.3, 0.01 * i}, random).size();
  }
  EXPECT_LE(found, 3U);
}

TEST(WallEdgesTest, CornersAreNone) {
  EXPECT_TRUE(test::features_at(test::l_room(), {}).edges.empty());
}

TEST(WallEdgesTest, FewPointsHaveNone) {
  EXPECT_TRUE(extract_scan_features({}, {}).edges.empty());
  const std::vector<topomap::ScanPoint> three{{1.0F, 0.0F}, {1.0F, 0.1F}, {1.1F, 0.2F}};
  EXPECT_TRUE(extract_scan_features(three, {}).edges.empty());
}

}  // namespace
}  // namespace topogeo::localization
