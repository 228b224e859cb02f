// Hand-made branches between known walls.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/matching/match_features.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using topomap::LocalMap;
using topomap::ScanPoint;

// A branch along x from 0 to 4 m, every 4 cm; `clearance_m` is a function of x.
template <typename Clearance>
LocalMap map_with_branch(const Clearance& clearance_m) {
  LocalMap map;
  topomap::LocalBranch branch;
  for (int i = 0; i <= 100; ++i) {
    const double x = 0.04 * i;
    branch.points.push_back({{x, 0.0}, clearance_m(x)});
  }
  map.branches.push_back(branch);
  return map;
}

TEST(BranchWallsTest, LieAtTheClearanceToBothSidesInACorridor) {
  const BranchWalls walls = walls_of_branches(map_with_branch([](double) { return 0.9; }));
  ASSERT_EQ(walls.points.size(), 202U);
  for (const ScanPoint& p : walls.points) EXPECT_NEAR(std::fabs(p.y_m), 0.9, 1e-6);
  EXPECT_EQ(std::count_if(walls.points.begin(), walls.points.end(),
                          [](const ScanPoint& p) { return p.y_m > 0.0F; }),
            101);
}

// Two walls that diverge by 2 x 20 degrees: the clearance rises by the sine of 20 degrees, the
// walls are the lines y = +-tan(20 degrees) x.
TEST(BranchWallsTest, LieOnWallsThatPart) {
  const double half_rad = 20.0 * 3.14159265358979 / 180.0;
  const BranchWalls walls =
      walls_of_branches(map_with_branch([&](double x) { return std::sin(half_rad) * (x + 1.0); }));
  ASSERT_FALSE(walls.points.empty());
  for (const ScanPoint& p : walls.points) {
    EXPECT_NEAR(std::fabs(p.y_m), std::tan(half_rad) * (p.x_m + 1.0), 1e-6);
  }
}

// Between two posts at (2, +-0.5): every circle touches both of them. The slope of the clearance is
// that of the chord over 0.4 m, off by up to 0.06 here: 3 cm at half a metre.
TEST(BranchWallsTest, AreThePostsOfADoor) {
  const BranchWalls walls =
      walls_of_branches(map_with_branch([](double x) { return std::hypot(x - 2.0, 0.5); }));
  ASSERT_FALSE(walls.points.empty());
  for (const ScanPoint& p : walls.points) {
    EXPECT_NEAR(p.x_m, 2.0, 0.04);
    EXPECT_NEAR(std::fabs(p.y_m), 0.5, 0.04);
  }
}

TEST(BranchWallsTest, AreInTheOrderOfTheBearingFromTheLaser) {
  LocalMap map = map_with_branch([](double) { return 0.9; });
  map.T_robot_laser = {1.0, 0.2, 0.5};
  const BranchWalls walls = walls_of_branches(map);
  const Pose2 T_laser_robot = geometry::inverse(map.T_robot_laser);
  double last_rad = -4.0;
  for (const ScanPoint& p : walls.points) {
    const Eigen::Vector2d seen = T_laser_robot * Eigen::Vector2d(p.x_m, p.y_m);
    const double bearing_rad = std::atan2(seen.y(), seen.x());
    EXPECT_GE(bearing_rad, last_rad - 1e-6);
    last_rad = bearing_rad;
  }
}

TEST(BranchWallsTest, NothingComesOfVirtualBranchesAndOfNone) {
  LocalMap map = map_with_branch([](double) { return 0.9; });
  map.branches.front().is_virtual = true;
  EXPECT_TRUE(walls_of_branches(map).points.empty());
  EXPECT_TRUE(walls_of_branches({}).points.empty());
  map.branches.front().is_virtual = false;
  map.branches.front().points.resize(1);
  EXPECT_TRUE(walls_of_branches(map).points.empty());
}

// The scan is the oracle: it plays no part in the walls, which must lie on its surfaces.
TEST(BranchWallsTest, LieOnTheScanOfAFloor) {
  LocalMap map = test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0);
  const std::vector<ScanPoint> scan = std::move(map.points);
  map.points.clear();
  const BranchWalls walls = walls_of_branches(map);
  ASSERT_GT(walls.points.size(), 50U);
  std::size_t near = 0;
  for (const ScanPoint& wall : walls.points) {
    const auto off_m = [&](const ScanPoint& p) {
      return std::hypot(p.x_m - wall.x_m, p.y_m - wall.y_m);
    };
    near +=
        std::any_of(scan.begin(), scan.end(), [&](const ScanPoint& p) { return off_m(p) < 0.10; })
            ? 1
            : 0;
  }
  EXPECT_GT(near * 10, walls.points.size() * 9);
}

TEST(BranchWallsTest, TakeThePlaceOfTheScanAmongTheFeatures) {
  const LocalMap map = test::map_at(test::world("floor"), {8.6, 1.2, 0.1}, 0);
  const MatchFeatures seen = extract_features(map);
  const MatchFeatures known = with_walls(seen, walls_of_branches(map));
  EXPECT_EQ(known.nodes.size(), seen.nodes.size());
  EXPECT_EQ(known.branches.size(), seen.branches.size());
  LocalMap other = map;
  other.points.clear();
  const MatchFeatures without = with_walls(extract_features(other), walls_of_branches(other));
  ASSERT_EQ(known.surface.size(), without.surface.size());
  for (std::size_t i = 0; i < known.surface.size(); ++i) {
    EXPECT_EQ(known.surface[i].position_m, without.surface[i].position_m);
  }
  EXPECT_EQ(points_for(map, MatchEvidence::kScan).size(), map.points.size());
  EXPECT_EQ(points_for(map, MatchEvidence::kBranches).size(), walls_of_branches(map).points.size());
}

}  // namespace
}  // namespace topogeo::localization
