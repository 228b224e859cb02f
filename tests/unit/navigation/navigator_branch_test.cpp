// Driving along branches: along their curves, without a grid, and with a wrong grid.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

std::shared_ptr<const topomap::GlobalMap> branch_through(
    const std::vector<Eigen::Vector2d>& points_m, double clearance_m, bool is_virtual = false) {
  auto graph = std::make_shared<topomap::GlobalMap>();
  graph->nodes.push_back({1, topomap::NodeKind::kReal, points_m.front(), clearance_m, 1});
  graph->nodes.push_back({2, topomap::NodeKind::kReal, points_m.back(), clearance_m, 1});
  topomap::MapBranch branch;
  branch.node_a = 1;
  branch.node_b = 2;
  branch.is_virtual = is_virtual;
  for (const Eigen::Vector2d& point_m : points_m) branch.points.push_back({point_m, clearance_m});
  graph->branches.push_back(branch);
  return graph;
}

// The branch leads through the middle of the room and turns there; the straight line is 5.7 m.
TEST(NavigatorBranch, FollowsTheBranchAndNotTheStraightLine) {
  DriveSettings settings;
  settings.T_world_start = {2.0, 1.0, 0.0};
  settings.graph = branch_through({{2.0, 1.0}, {6.0, 1.0}, {6.0, 5.0}}, 1.0);
  TestDrive drive(room(), settings);
  drive.go_to({6.0, 5.0});
  double inside_m = 0.0;  // how far it cuts the corner
  ASSERT_TRUE(drive.run_until(
      [&] {
        const Eigen::Vector2d at_m = drive.robot.T_world_robot().position_m();
        inside_m = std::max(inside_m, std::min(6.0 - at_m.x(), at_m.y() - 1.0));
        return drive.status().state == NavigatorState::kArrived;
      },
      60.0))
      << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_LT(inside_m, 0.25);
  EXPECT_NEAR(drive.status().driven_m, 8.0, 0.5);
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

TEST(NavigatorBranch, DrivesWithoutAnyGrid) {
  DriveSettings settings;
  settings.T_world_start = {2.0, 1.5, 0.0};
  settings.map_comes = false;
  settings.graph = branch_through({{2.0, 1.5}, {5.0, 1.5}, {8.5, 1.5}}, 0.45);
  TestDrive drive(two_doors(), settings);
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_LT(drive.off_m(), 0.05);
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

TEST(NavigatorBranch, WithoutAGridItDrivesNoRouteOnAGrid) {
  DriveSettings settings;
  settings.T_world_start = {2.0, 1.5, 0.0};
  settings.map_comes = false;
  TestDrive drive(two_doors(), settings);
  drive.go_to({4.0, 1.5});
  EXPECT_FALSE(drive.arrives(5.0));
  EXPECT_TRUE(drive.halted(HaltReason::kNoMap));
}

// The grid has objects in both doors that are not there, so it has no route.
TEST(NavigatorBranch, DrivesThroughADoorThatIsShutOnTheGridAlone) {
  DriveSettings settings;
  settings.T_world_start = {2.0, 1.5, 0.0};
  settings.noise_m = {{4.95, 1.5}, {5.05, 1.55}, {5.05, 4.5}};
  TestDrive shut(two_doors(), settings);
  shut.go_to({8.5, 1.5});
  EXPECT_FALSE(shut.arrives(5.0));
  settings.graph = branch_through({{2.0, 1.5}, {5.0, 1.5}, {8.5, 1.5}}, 0.45);
  TestDrive drive(two_doors(), settings);
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
  EXPECT_GT(drive.shortest_clearance_m, 0.28);
}

// A virtual branch contains no information about the space beside it.
TEST(NavigatorBranch, FollowsAVirtualBranch) {
  DriveSettings settings;
  settings.T_world_start = {2.0, 1.5, 0.0};
  settings.noise_m = {{5.05, 1.55}, {5.05, 4.5}};
  settings.graph = branch_through({{2.0, 1.5}, {8.5, 1.5}}, 0.0, true);
  TestDrive drive(two_doors(), settings);
  drive.go_to({8.5, 1.5});
  ASSERT_TRUE(drive.arrives(60.0)) << drive.status().message;
  EXPECT_EQ(drive.robot.collisions(), 0U);
}

// Adds points from one place to the other, one for each cell.
void add_line(std::vector<Eigen::Vector2d>& points_m, const Eigen::Vector2d& from_m,
              const Eigen::Vector2d& to_m) {
  const int steps = static_cast<int>(std::lround((to_m - from_m).norm() / 0.1));
  for (int k = 0; k <= steps; ++k) {
    points_m.emplace_back(from_m + static_cast<double>(k) / steps * (to_m - from_m));
  }
}

world::ChangingPart standing_box(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m) {
  world::ChangingPart part;
  const Eigen::Vector2d right_m(high_m.x(), low_m.y());
  const Eigen::Vector2d left_m(low_m.x(), high_m.y());
  part.segments = {{low_m, right_m}, {right_m, high_m}, {high_m, left_m}, {left_m, low_m}};
  part.present_s = {{0.0, 1e6}};
  return part;
}

// A partition with an opening crossed the room when it was mapped, and is gone; now a box is in
// front of the opening. The grid has no way round.
TEST(NavigatorBranch, ADetourFollowsTheBranchesOfTheScanWhereTheGridHasNone) {
  for (const bool has_local_map : {false, true}) {
    world::World world = room();
    world.changing.push_back(standing_box({3.3, 2.3}, {3.7, 3.7}));
    DriveSettings settings;
    settings.T_world_start = {1.0, 3.0, 0.0};
    settings.scans_whole = has_local_map;
    add_line(settings.noise_m, {4.05, 0.05}, {4.05, 2.45});
    add_line(settings.noise_m, {4.05, 3.55}, {4.05, 5.95});
    TestDrive drive(world, settings);
    drive.go_to({7.0, 3.0});
    EXPECT_EQ(drive.arrives(90.0), has_local_map) << drive.status().message;
    EXPECT_EQ(drive.robot.collisions(), 0U);
    EXPECT_EQ(drive.status().branch_detours > 0, has_local_map);
    EXPECT_EQ(drive.status().virtual_detours, 0U);
    EXPECT_GT(drive.shortest_clearance_m, 0.3);
  }
}

// A hall whose walls are out of view, mapped with a partition on either side of the route. The
// partitions are gone; the laser sees only a box on the right of the route: one group. The grid has
// no room between the box and the left partition.
TEST(NavigatorBranch, AVirtualDiagramLeadsRoundWhereOneGroupIsInSight) {
  for (const bool has_local_map : {false, true}) {
    world::World world = world::parse_world(R"(
name: hall
walls:
  - {from: [0, 0], to: [60, 0]}
  - {from: [60, 0], to: [60, 60]}
  - {from: [60, 60], to: [0, 60]}
  - {from: [0, 60], to: [0, 0]}
tour: [[25, 30], [35, 30]]
)",
                                            "hall");
    world.changing.push_back(standing_box({30.0, 28.6}, {30.6, 29.9}));
    DriveSettings settings;
    settings.T_world_start = {25.0, 30.0, 0.0};
    settings.scans_whole = has_local_map;
    add_line(settings.noise_m, {20.05, 28.45}, {40.05, 28.45});
    add_line(settings.noise_m, {20.05, 30.55}, {40.05, 30.55});
    TestDrive drive(world, settings);
    drive.go_to({35.0, 30.0});
    EXPECT_EQ(drive.arrives(90.0), has_local_map) << drive.status().message;
    EXPECT_EQ(drive.robot.collisions(), 0U);
    EXPECT_EQ(drive.status().virtual_detours > 0, has_local_map);
  }
}

}  // namespace
}  // namespace topogeo::navigation
