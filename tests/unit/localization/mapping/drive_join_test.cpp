#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/slam/stored_map.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using DriveMaps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

Eigen::Matrix3d known_to(double sigma_m) {
  return Eigen::Vector3d(sigma_m * sigma_m, sigma_m * sigma_m, 1e-6).asDiagonal();
}

// A map of three stops along x.
PoseGraph map_along_x() {
  PoseGraph graph;
  for (std::uint32_t i = 0; i < 3; ++i) {
    graph.add_pose({1.0 * i, 0.0, 0.0});
    if (i > 0) graph.add_edge({i - 1, i, EdgeKind::kSequential, {1.0, 0.0, 0.0}, known_to(0.02)});
  }
  return graph;
}

// A drive along y in odometry that starts at (5, 5), facing y.
DriveMaps drive_along_y(std::uint32_t stops) {
  DriveMaps drive;
  for (std::uint32_t i = 0; i < stops; ++i) {
    auto map = std::make_shared<topomap::LocalMap>();
    map->T_odom_robot = Pose2{5.0, 5.0, 1.5707963267948966} * Pose2{1.0 * i, 0.0, 0.0};
    drive.push_back(map);
  }
  return drive;
}

// The drive's last stop, 2 m on from its first, is 1 m to the left of stop 0 of the map and faces
// x. Its first stop is therefore at (-2, 1), which is (-4, 1) seen from stop 2.
TEST(DriveJoin, ItsFirstStopFollowsFromTheMatchOfItsLast) {
  const std::vector<StoredMatch> matches{{0, {{0.0, 1.0, 0.0}, known_to(0.02)}, 0.9}};
  const UncertainPose first = first_stop_of_drive(map_along_x(), drive_along_y(3), matches, {});
  EXPECT_NEAR(first.T_a_b.x_m, -4.0, 1e-9);
  EXPECT_NEAR(first.T_a_b.y_m, 1.0, 1e-9);
  EXPECT_NEAR(first.T_a_b.theta_rad, 0.0, 1e-9);
  EXPECT_GT(first.covariance(0, 0), 0.02 * 0.02);
}

TEST(DriveJoin, TheSurestMatchCounts) {
  const std::vector<StoredMatch> matches{{2, {{0.3, 0.0, 0.0}, known_to(0.5)}, 0.9},
                                         {1, {{1.0, 0.0, 0.0}, known_to(0.02)}, 0.7}};
  const UncertainPose first = first_stop_of_drive(map_along_x(), drive_along_y(1), matches, {});
  EXPECT_NEAR(first.T_a_b.x_m, 0.0, 1e-9);  // 1 m on from stop 1 is stop 2
}

TEST(DriveJoin, RefusesWhatDoesNotJoin) {
  const std::vector<StoredMatch> matches{{0, {{0.0, 1.0, 0.0}, known_to(0.02)}, 0.9}};
  EXPECT_THROW(first_stop_of_drive(map_along_x(), {}, matches, {}), std::invalid_argument);
  EXPECT_THROW(first_stop_of_drive(map_along_x(), drive_along_y(1), {}, {}), std::invalid_argument);
  EXPECT_THROW(first_stop_of_drive(PoseGraph(), drive_along_y(1), matches, {}),
               std::invalid_argument);
  const std::vector<StoredMatch> unknown{{3, {{0.0, 1.0, 0.0}, known_to(0.02)}, 0.9}};
  EXPECT_THROW(first_stop_of_drive(map_along_x(), drive_along_y(1), unknown, {}),
               std::invalid_argument);
}

TEST(DriveJoin, AMatchIsALoopOfItsLastStop) {
  const PoseGraphEdge loop = loop_of({1, {{0.5, 0.0, 0.1}, known_to(0.02)}, 0.9}, 7);
  EXPECT_EQ(loop.from, 1U);
  EXPECT_EQ(loop.to, 7U);
  EXPECT_EQ(loop.kind, EdgeKind::kRevisit);
  EXPECT_EQ(loop.T_from_to, (Pose2{0.5, 0.0, 0.1}));
  std::vector<PoseGraphEdge> edges{loop};
  PoseGraphEdge other = loop;
  other.T_from_to = {};
  EXPECT_TRUE(contains_like(edges, other));
  other.kind = EdgeKind::kSequential;
  EXPECT_FALSE(contains_like(edges, other));
  other = loop;
  other.to = 8;
  EXPECT_FALSE(contains_like(edges, other));
  EXPECT_FALSE(contains_like({}, loop));
}

}  // namespace
}  // namespace topogeo::localization
