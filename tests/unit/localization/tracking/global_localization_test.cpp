#include "topogeo/relocalization/global_localization.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "localization/simulated_maps.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;

/// The map of a drive through the simulated floor with its true poses.
struct FinishedMap {
  std::vector<topomap::LocalMap> maps;
  topomap::Trajectory trajectory;

  explicit FinishedMap(const std::string& name) {
    const test::DrivenMaps driven = test::drive(test::world(name), {});
    for (std::size_t i = 0; i < driven.maps.size(); ++i) {
      maps.push_back(*driven.maps[i]);
      trajectory.stops.push_back(
          {maps[i].id, maps[i].stamp_ns, driven.T_world_robot[i], Eigen::Matrix3d::Zero()});
    }
  }
};

std::vector<topomap::ScanPoint> points_at(const world::World& world, const Pose2& T) {
  return test::map_at(world, T, 9000).points;
}

bool is_right(const Pose2& a, const Pose2& b) {
  return (a.position_m() - b.position_m()).norm() < 0.3 &&
         std::fabs(geometry::wrap_angle(a.theta_rad - b.theta_rad)) < 0.087;
}

TEST(GlobalLocalizer, FindsScansThatAreNotInTheMapAndAcceptsNoWrongPlace) {
  const FinishedMap map("floor");
  const world::World world = test::world("floor");
  const GlobalLocalizer localizer(map.maps, map.trajectory);
  int asked = 0;
  int right = 0;
  int accepted = 0;
  for (std::size_t i = 0; i + 1 < map.trajectory.stops.size(); i += 12) {
    // Beside the path, with another heading.
    const Pose2 T = map.trajectory.stops[i].T_map_robot * Pose2{0.15, 0.1, 0.12};
    const GlobalAnswer answer = localizer.find(points_at(world, T), {});
    ASSERT_FALSE(answer.poses.empty());
    const bool ok = is_right(answer.poses.front().T_map_robot, T);
    ++asked;
    right += ok ? 1 : 0;
    if (answer.verdict != Verdict::kAccepted) continue;
    ++accepted;
    EXPECT_TRUE(ok) << "at stop " << i;
    EXPECT_LE(answer.rivalry, 0.85);
    EXPECT_GT(answer.poses.front().covariance(0, 0), 0.0);
  }
  EXPECT_GE(right * 10, asked * 9) << right << " of " << asked;
  EXPECT_GE(accepted * 2, asked);
}

TEST(GlobalLocalizer, AnswersTheSameTwice) {
  const FinishedMap map("floor");
  const GlobalLocalizer localizer(map.maps, map.trajectory);
  const auto points = points_at(test::world("floor"), map.trajectory.stops[20].T_map_robot);
  const GlobalAnswer a = localizer.find(points, {});
  const GlobalAnswer b = localizer.find(points, {});
  ASSERT_EQ(a.poses.size(), b.poses.size());
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    EXPECT_EQ(a.poses[i].T_map_robot, b.poses[i].T_map_robot);
    EXPECT_EQ(a.poses[i].fitness, b.poses[i].fitness);
  }
}

TEST(GlobalLocalizer, ARoomOfAnotherBuildingIsNotAccepted) {
  const FinishedMap map("floor");
  const FinishedMap other("room");
  const GlobalLocalizer localizer(map.maps, map.trajectory);
  for (std::size_t i = 0; i < other.maps.size(); i += 3) {
    EXPECT_NE(localizer.find(other.maps[i].points, {}).verdict, Verdict::kAccepted) << i;
  }
}

TEST(GlobalLocalizer, AScanOfNextToNothingIsRejected) {
  const FinishedMap map("room");
  const GlobalLocalizer localizer(map.maps, map.trajectory);
  const GlobalAnswer answer = localizer.find({}, {});
  EXPECT_EQ(answer.verdict, Verdict::kRejected);
  EXPECT_TRUE(answer.poses.empty());
}

TEST(GlobalLocalizer, AMapWithoutStopsOrPointsIsAnError) {
  EXPECT_THROW(GlobalLocalizer({}, {}), std::invalid_argument);
  const std::vector<topomap::LocalMap> blind(1);
  topomap::Trajectory trajectory;
  trajectory.stops.resize(1);
  EXPECT_THROW(GlobalLocalizer(blind, trajectory), std::invalid_argument);
}

// The oracle: at its true pose the map contains the scan's view; at a wrong one it has seen free
// space there, and beyond its walls it knows nothing.
TEST(GlobalLocalizer, KnowsWhatAScanShowsAndContradictsItElsewhere) {
  const FinishedMap map("floor");
  const GlobalLocalizer localizer(map.maps, map.trajectory);
  const topomap::LocalMap& stop = map.maps[20];
  const MatchFeatures scan = extract_scan_features(stop.points, stop.T_robot_laser);
  const Pose2& T_right = map.trajectory.stops[20].T_map_robot;
  const KnownView right = localizer.known_view(scan, T_right);
  EXPECT_GT(right.known(), 0.95);
  EXPECT_LT(right.contradicted, 0.03);
  const KnownView turned = localizer.known_view(scan, T_right * Pose2{0.0, 0.0, 0.8});
  EXPECT_GT(turned.contradicted, 0.2 * turned.known());
  EXPECT_LE(turned.known(), 1.0 + 1e-9);
  const KnownView outside = localizer.known_view(scan, Pose2{500.0, 0.0, 0.0});
  EXPECT_EQ(outside.known(), 0.0);
  EXPECT_EQ(localizer.known_view({}, T_right).known(), 0.0);
}

TEST(KernelGrid, IsFullAtAPointAndNothingBeyondItsWidth) {
  const std::vector<Eigen::Vector2d> points{{1.0, 2.0}};
  const KernelGrid grid(points, 0.05, 0.3, 1.0);
  EXPECT_GT(grid.at(1.0, 2.0), 240);
  EXPECT_GT(grid.at(1.1, 2.0), grid.at(1.2, 2.0));
  EXPECT_EQ(grid.at(1.4, 2.0), 0);
  EXPECT_EQ(grid.at(1e9, -1e9), 0);
  EXPECT_EQ(KernelGrid().at(0.0, 0.0), 0);
}

TEST(Climb, EndsWherePointsLieOnThoseOfTheGrid) {
  std::vector<Eigen::Vector2d> corner;
  for (int i = 0; i <= 40; ++i) {
    corner.emplace_back(0.05 * i, 0.0);
    corner.emplace_back(0.0, 0.05 * i);
  }
  const KernelGrid grid(corner, 0.05, 0.3, 1.0);
  const Climbed climbed = climb(grid, corner, {0.14, -0.1, 0.06});
  EXPECT_NEAR(climbed.T_map_robot.x_m, 0.0, 0.05);
  EXPECT_NEAR(climbed.T_map_robot.y_m, 0.0, 0.05);
  EXPECT_NEAR(climbed.T_map_robot.theta_rad, 0.0, 0.05);
  EXPECT_GT(climbed.value, 0.9);
}

}  // namespace
}  // namespace topogeo::localization
