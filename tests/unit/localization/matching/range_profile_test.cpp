#include "topogeo/matching/range_profile.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "localization/hand_scenes.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::kDegree;
using View = RangeProfile::View;

TEST(RangeProfileTest, WithoutAScanEverythingIsUnknown) {
  EXPECT_EQ(RangeProfile().view({1.0, 0.0}, 0.3), View::kUnknown);
}

// The front half of a square room: walls at x = 2, y = 2 and y = -2.
TEST(RangeProfileTest, TellsFreeSpaceFromSurfacesAndWhatIsBehind) {
  const world::World room =
      test::lines({{{-2, 2}, {2, 2}}, {{2, 2}, {2, -2}}, {{2, -2}, {-2, -2}}});
  const test::Sweep front{-90.0, 90.0, 0.5, 8.0};
  const RangeProfile profile(test::exact_points(room, {}, front), {});
  EXPECT_EQ(profile.view({1.0, 0.3}, 0.1), View::kFree);
  EXPECT_EQ(profile.view({1.85, 0.3}, 0.1), View::kFree);
  EXPECT_EQ(profile.view({1.95, 0.3}, 0.1), View::kSurface);
  EXPECT_EQ(profile.view({2.05, 0.3}, 0.1), View::kSurface);
  EXPECT_EQ(profile.view({2.2, 0.3}, 0.1), View::kHidden);
  EXPECT_EQ(profile.view({2.2, 0.3}, 0.3), View::kSurface);
  EXPECT_EQ(profile.view({0.5, -1.0}, 0.1), View::kFree);
  EXPECT_EQ(profile.view({0.5, 3.0}, 0.1), View::kHidden);
  EXPECT_EQ(profile.view({-1.0, 0.3}, 0.1), View::kUnknown);
}

TEST(RangeProfileTest, TellsTheFaceThatItSawFromTheOneBehind) {
  const RangeProfile profile(
      test::exact_points(test::lines({{{2, -4}, {2, 4}}}), {}, {-45, 45, 0.5, 8}), {});
  const Eigen::Vector2d near{-1.0, 0.0};
  const Eigen::Vector2d far{1.0, 0.0};
  EXPECT_FALSE(profile.turned_away({2.0, 0.5}, near));
  EXPECT_TRUE(profile.turned_away({2.0, 0.5}, far));
  EXPECT_FALSE(profile.turned_away({2.0, 0.5}, Eigen::Vector2d::Zero())) << "of no side";
  // Nine and eleven degrees behind the plane of the wall.
  EXPECT_FALSE(profile.turned_away({2.0, 0.0}, {std::sin(9 * kDegree), std::cos(9 * kDegree)}));
  EXPECT_TRUE(profile.turned_away({2.0, 0.0}, {std::sin(11 * kDegree), std::cos(11 * kDegree)}));
  EXPECT_EQ(profile.view_of_face({2.1, 0.5}, near, 0.2), View::kSurface);
  EXPECT_EQ(profile.view_of_face({2.1, 0.5}, far, 0.2), View::kHidden);
  EXPECT_EQ(profile.view_of_face({1.0, 0.5}, far, 0.2), View::kFree) << "it looked past it";
  EXPECT_EQ(profile.view_of_face({-1.0, 0.5}, far, 0.2), View::kUnknown);
}

TEST(RangeProfileTest, SmallGapsBetweenBeamsBelongToTheNearerReading) {
  const world::World wall = test::lines({{{2, -4}, {2, 4}}});
  const RangeProfile coarse(test::exact_points(wall, {}, {-45, 45, 1.5, 8}), {});
  for (double angle = -44.0; angle <= 44.0; angle += 0.25) {
    const Eigen::Vector2d toward(std::cos(angle * kDegree), std::sin(angle * kDegree));
    EXPECT_EQ(coarse.view(toward, 0.1), View::kFree) << angle;
  }
  // Twenty degrees without readings are more than a gap between beams.
  auto points = test::exact_points(wall, {}, {-45, -10, 0.5, 8});
  for (const auto& p : test::exact_points(wall, {}, {10, 45, 0.5, 8})) points.push_back(p);
  EXPECT_EQ(RangeProfile(points, {}).view({1.0, 0.0}, 0.1), View::kUnknown);
}

TEST(RangeProfileTest, LooksFromWhereTheLaserIsMounted) {
  // The laser is mounted 1 m ahead of the robot's origin and faces left; it sees a wall at 2 m.
  const Pose2 T_robot_laser{1.0, 0.0, 90.0 * kDegree};
  std::vector<topomap::ScanPoint> points;
  for (double x = 0.0; x <= 2.0; x += 0.02) points.push_back({static_cast<float>(x), 2.0F});
  const RangeProfile profile(points, T_robot_laser);
  EXPECT_EQ(profile.view({1.0, 1.0}, 0.1), View::kFree);
  EXPECT_EQ(profile.view({1.0, 2.0}, 0.1), View::kSurface);
  EXPECT_EQ(profile.view({1.0, 2.5}, 0.1), View::kHidden);
  EXPECT_EQ(profile.view({1.0, -1.0}, 0.1), View::kUnknown);
  // The robot's origin would see this place free, but it is outside the laser's view of the wall.
  EXPECT_EQ(profile.view({0.0, 0.5}, 0.1), View::kUnknown);
}

}  // namespace
}  // namespace topogeo::localization
