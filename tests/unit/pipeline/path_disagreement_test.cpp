#include "topogeo/pipeline/path_disagreement.hpp"

#include <functional>
#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using geometry::Pose2;
using Disagreement = PathDisagreement::Kind;

/// Twelve stops, half a metre apart by odometry, and where the map has them.
storage::MapDocument drive(const std::function<Pose2(std::uint32_t)>& T_map_robot) {
  storage::MapDocument document;
  for (std::uint32_t id = 0; id < 12; ++id) {
    topomap::LocalMap map;
    map.id = id;
    map.T_odom_robot = {0.5 * id, 0.0, 0.0};
    document.local_maps.push_back(map);
    topomap::StopPose stop;
    stop.local_map_id = id;
    stop.T_map_robot = T_map_robot(id);
    document.trajectory.stops.push_back(stop);
  }
  return document;
}

TEST(PathDisagreement, NoneIfTheMapFollowsOdometry) {
  const auto comparison = compare_with_odometry(drive([](std::uint32_t id) {
    return Pose2{0.52 * id, 0.02 * id, 0.01 * id};
  }));
  EXPECT_TRUE(comparison.disagreements.empty());
  EXPECT_LT(comparison.typical_share, 0.1);
}

TEST(PathDisagreement, NamesAPathThatIsTooLong) {
  const auto comparison = compare_with_odometry(drive([](std::uint32_t id) {
    return Pose2{0.7 * id, 0.0, 0.0};
  }));
  ASSERT_EQ(comparison.disagreements.size(), 1U);  // overlapping parts are one
  const PathDisagreement& found = comparison.disagreements[0];
  EXPECT_EQ(found.kind, Disagreement::kLength);
  EXPECT_EQ(found.first_id, 0U);
  EXPECT_EQ(found.last_id, 11U);
  EXPECT_NEAR(found.corrected_m / found.odometry_m, 1.4, 1e-9);
  EXPECT_NEAR(comparison.typical_share, 0.4, 1e-9);
  EXPECT_NEAR(comparison.scale, 1.4, 1e-9);
}

TEST(PathDisagreement, AScaleIsThatOfNearlyAllParts) {
  const auto half = compare_with_odometry(drive([](std::uint32_t id) {
    return Pose2{0.5 * id + (id > 6 ? 0.05 * (id - 6) : 0.0), 0.0, 0.0};
  }));
  EXPECT_EQ(half.scale, 1.0);
  EXPECT_EQ(compare_with_odometry({}).scale, 1.0);
}

TEST(PathDisagreement, NamesATurnThatOdometryDoesNotMake) {
  const auto comparison = compare_with_odometry(drive([](std::uint32_t id) {
    return id < 6 ? Pose2{0.5 * id, 0.0, 0.0} : Pose2{2.5, 0.5 * (id - 5), std::numbers::pi / 2.0};
  }));
  ASSERT_EQ(comparison.disagreements.size(), 1U);
  EXPECT_EQ(comparison.disagreements[0].kind, Disagreement::kTurn);
  EXPECT_NEAR(comparison.disagreements[0].turn_rad, std::numbers::pi / 2.0, 1e-9);
}

TEST(PathDisagreement, NamesAJumpBetweenScans) {
  storage::MapDocument document = drive([](std::uint32_t id) { return Pose2{0.5 * id, 0.0, 0.0}; });
  // The tracked scans stand for most of the step to stop 6, which odometry drives in 2 m.
  for (std::uint32_t id = 6; id < 12; ++id) {
    document.local_maps[id].T_odom_robot.x_m += 1.5;
    document.trajectory.stops[id].T_map_robot.x_m += 1.5;
  }
  for (int i = 1; i <= 4; ++i) {
    topomap::TrackedScan scan;
    scan.T_odom_robot = {2.5 + 0.45 * i, 0.0, 0.0};
    document.local_maps[6].track.push_back(scan);
  }
  const auto comparison = compare_with_odometry(document);
  ASSERT_EQ(comparison.disagreements.size(), 1U);
  EXPECT_EQ(comparison.disagreements[0].kind, Disagreement::kJump);
  EXPECT_EQ(comparison.disagreements[0].last_id, 6U);
  EXPECT_NEAR(comparison.disagreements[0].corrected_m, 2.0, 1e-9);
}

TEST(PathDisagreement, NamesStepsOfWhichTheScansContradictTheOdometry) {
  storage::MapDocument document = drive([](std::uint32_t id) { return Pose2{0.5 * id, 0.0, 0.0}; });
  // The wheels spin on the steps to stops 6 and 7.
  for (std::uint32_t id = 6; id < 12; ++id) {
    const double spun_m = id == 6 ? 1.0 : 2.0;
    topomap::LocalMap& map = document.local_maps[id];
    map.T_odom_robot.x_m += spun_m;
    map.T_previous_robot = {0.5, 0.0, 0.0};
    map.track.push_back({0, 0, map.T_odom_robot, map.T_previous_robot, true});
  }
  const auto comparison = compare_with_odometry(document);
  ASSERT_EQ(comparison.disagreements.size(), 1U) << "no other length, no jump";
  const PathDisagreement& found = comparison.disagreements[0];
  EXPECT_EQ(found.kind, Disagreement::kWheels);
  EXPECT_EQ(found.first_id, 5U);
  EXPECT_EQ(found.last_id, 7U);
  EXPECT_NEAR(found.odometry_m, 3.0, 1e-9);
  EXPECT_NEAR(found.corrected_m, 1.0, 1e-9);
}

TEST(PathDisagreement, NamesTheStopWhereACarriedRobotGoesOn) {
  storage::MapDocument document = drive([](std::uint32_t id) { return Pose2{0.5 * id, 0.0, 0.0}; });
  for (std::uint32_t id = 0; id < 12; ++id) {
    document.local_maps[id].odometry_epoch = 7;
    document.local_maps[id].stop = {id < 6 ? 1U : 2U, id < 6 ? id : id - 6};
  }
  document.local_maps[6].starts_drive = true;
  const auto comparison = compare_with_odometry(document);
  ASSERT_EQ(comparison.disagreements.size(), 1U);
  EXPECT_EQ(comparison.disagreements[0].kind, Disagreement::kCarried);
  EXPECT_EQ(comparison.disagreements[0].last_id, 6U);
  document.local_maps[6].odometry_epoch = 8;
  EXPECT_TRUE(compare_with_odometry(document).disagreements.empty()) << "another base";
}

TEST(PathDisagreement, ComparesNothingAcrossDrives) {
  storage::MapDocument document = drive([](std::uint32_t id) { return Pose2{2.0 * id, 0.0, 0.0}; });
  for (topomap::LocalMap& map : document.local_maps) map.starts_drive = true;
  EXPECT_TRUE(compare_with_odometry(document).disagreements.empty());
  EXPECT_TRUE(compare_with_odometry({}).disagreements.empty());
}

}  // namespace
}  // namespace topogeo::pipeline
