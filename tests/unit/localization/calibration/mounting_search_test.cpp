// find_mounting on drives through made worlds with a laser at a known place of the robot.
#include "topogeo/calibration/mounting_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "localization/laser_drives.hpp"

namespace topogeo::localization {
namespace {

using geometry::Pose2;
using test::drive;
using test::kRound_m;
using test::mirror;
using test::motions_of;

constexpr double kDegree_rad = std::numbers::pi / 180.0;

FoundMounting find(const std::vector<scan::Scan>& scans) {
  return find_mounting(motions_of(scans));
}

void expect_mounting(const FoundMounting& found, const Pose2& truth) {
  EXPECT_TRUE(found.heading_known);
  EXPECT_TRUE(found.position_known);
  EXPECT_GT(found.confidence(), 0.9);
  EXPECT_NEAR(geometry::wrap_angle(found.T_robot_laser.theta_rad - truth.theta_rad), 0.0,
              1.0 * kDegree_rad);
  EXPECT_NEAR(found.T_robot_laser.x_m, truth.x_m, std::max(0.01, 3.0 * found.position_spread_m));
  EXPECT_NEAR(found.T_robot_laser.y_m, truth.y_m, std::max(0.01, 3.0 * found.position_spread_m));
}

class MountingSearchTest : public testing::TestWithParam<Pose2> {};

TEST_P(MountingSearchTest, FindsTheMountingOfADrive) {
  const FoundMounting found = find(drive("floor", kRound_m, GetParam()));
  expect_mounting(found, GetParam());
  EXPECT_FALSE(found.upside_down);
}

TEST_P(MountingSearchTest, FindsTheMountingOfALaserUpsideDown) {
  std::vector<scan::Scan> scans = drive("floor", kRound_m, GetParam());
  mirror(scans);
  const FoundMounting found = find(scans);
  expect_mounting(found, GetParam());
  EXPECT_TRUE(found.upside_down);
}

INSTANTIATE_TEST_SUITE_P(Mountings, MountingSearchTest,
                         testing::Values(Pose2{}, Pose2{0.0, 0.0, 90.0 * kDegree_rad},
                                         Pose2{0.2, 0.0, std::numbers::pi},
                                         Pose2{0.1, -0.15, -90.0 * kDegree_rad},
                                         Pose2{0.25, 0.1, 37.0 * kDegree_rad}));

TEST(MountingSearchTest, AStraightDriveShowsTheHeadingAlone) {
  const FoundMounting found =
      find(drive("floor", {{1.3, 1.2}, {15.0, 1.2}}, {0.2, 0.0, std::numbers::pi}));
  EXPECT_TRUE(found.heading_known);
  EXPECT_FALSE(found.position_known);
  EXPECT_FALSE(found.side.decided());
  EXPECT_EQ(found.T_robot_laser, (Pose2{0.0, 0.0, std::numbers::pi}));
}

TEST(MountingSearchTest, AStandingRobotShowsNothing) {
  std::vector<scan::Scan> scans = drive("floor", kRound_m, {0.2, 0.0, std::numbers::pi});
  for (scan::Scan& scan : scans) {
    scan.ranges_m = scans.front().ranges_m;
    scan.T_odom_robot = scans.front().T_odom_robot;
  }
  const FoundMounting found = find(scans);
  EXPECT_EQ(found.motions, 0U);
  EXPECT_FALSE(found.heading_known || found.position_known || found.upside_down);
  EXPECT_EQ(found.confidence(), 0.0);
  EXPECT_EQ(found.T_robot_laser, Pose2{});
}

TEST(MountingSearchTest, TurnsOnTheSpotShowTheSideAlone) {
  const world::World world = test::world("floor");
  constexpr int kScans = 120;
  std::vector<scan::Scan> scans;
  scans.reserve(kScans);
  for (int i = 0; i < kScans; ++i) {
    scans.push_back(test::scan_at(world, {14.0, 1.2, 0.15 * i}, static_cast<std::uint64_t>(i)));
  }
  EXPECT_FALSE(find(scans).heading_known);
  EXPECT_TRUE(find(scans).side.decided());
  mirror(scans);
  const FoundMounting found = find(scans);
  EXPECT_FALSE(found.heading_known);
  EXPECT_TRUE(found.upside_down);
  EXPECT_EQ(found.T_robot_laser, Pose2{});
}

TEST(MountingSearchTest, OdometryThatContradictsTheScansShowsNothing) {
  std::vector<scan::Scan> scans = drive("floor", kRound_m, {0.2, 0.0, std::numbers::pi});
  for (std::size_t i = 0; i < scans.size(); ++i) {  // of another drive
    const double way = static_cast<double>(i);
    scans[i].T_odom_robot = {3.0 * std::sin(0.07 * way), 0.2 * std::cos(0.31 * way),
                             std::sin(0.11 * way)};
  }
  EXPECT_FALSE(find(scans).heading_known);
}

TEST(MountingSearchTest, RepeatsToTheLastBit) {
  const auto motions = motions_of(drive("floor", kRound_m, {0.2, 0.0, std::numbers::pi}));
  EXPECT_EQ(find_mounting(motions).T_robot_laser, find_mounting(motions).T_robot_laser);
}

}  // namespace
}  // namespace topogeo::localization
