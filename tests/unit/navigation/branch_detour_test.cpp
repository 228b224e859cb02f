// Detours along the branches of one scan, for a robot at the origin that faces x.
#include "branch_detour.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace topogeo::navigation {
namespace {

// Rectangles in the view of a laser with 181 beams over half a turn.
struct Box {
  Eigen::Vector2d low_m;
  Eigen::Vector2d high_m;
};

SeenScan scan_of(const std::vector<Box>& boxes) {
  auto scan = std::make_shared<scan::Scan>();
  scan->angle_min_rad = -std::numbers::pi / 2;
  scan->angle_step_rad = std::numbers::pi / 360;
  for (int i = 0; i <= 360; ++i) {
    const double angle_rad = scan->angle_min_rad + i * scan->angle_step_rad;
    const Eigen::Vector2d beam(std::cos(angle_rad), std::sin(angle_rad));
    double nearest_m = 1e9;
    for (const Box& box : boxes) {
      double enters_m = 0.0;
      double leaves_m = 1e9;
      for (int axis = 0; axis < 2; ++axis) {
        const double a_m = box.low_m[axis] / beam[axis];
        const double b_m = box.high_m[axis] / beam[axis];
        enters_m = std::max(enters_m, std::min(a_m, b_m));
        leaves_m = std::min(leaves_m, std::max(a_m, b_m));
      }
      if (enters_m < leaves_m && enters_m > 0.0) nearest_m = std::min(nearest_m, enters_m);
    }
    scan->ranges_m.push_back(nearest_m < 1e9 ? static_cast<float>(nearest_m)
                                             : scan::Scan::kNoReturn);
  }
  return {scan, {}, {}};
}

double least_distance_m(const std::vector<Eigen::Vector2d>& path_m, const Eigen::Vector2d& at_m) {
  double least_m = 1e9;
  for (std::size_t i = 1; i < path_m.size(); ++i) {
    for (int k = 0; k <= 50; ++k) {
      const Eigen::Vector2d on_m = path_m[i - 1] + k / 50.0 * (path_m[i] - path_m[i - 1]);
      least_m = std::min(least_m, (on_m - at_m).norm());
    }
  }
  return least_m;
}

planning::FreeSpace floor_with(const std::vector<planning::DrawnZone>& zones) {
  const std::vector<Eigen::Vector2d> corners_m{{-10.0, -10.0}, {10.0, 10.0}};
  return planning::FreeSpace(
      planning::OccupancyGrid(planning::frame_around(corners_m, 1.0), planning::CellState::kFree),
      {}, zones);
}

const std::vector<Eigen::Vector2d> kAhead{{0.0, 0.0}, {8.0, 0.0}};

// A box fills the right half and the middle of a corridor of 4 m.
TEST(BranchDetour, LeadsThroughTheMiddleOfTheGap) {
  const SeenScan seen =
      scan_of({{{-1.0, 2.0}, {9.0, 2.2}}, {{-1.0, -2.2}, {9.0, -2.0}}, {{3.0, -1.9}, {3.5, 0.4}}});
  const auto detour = detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, floor_with({}), {});
  ASSERT_TRUE(detour);
  EXPECT_FALSE(detour->is_virtual);
  EXPECT_TRUE(detour->points_m.back().isApprox(kAhead.back()));
  const Eigen::Vector2d corner_m(3.0, 0.4);
  EXPECT_GT(least_distance_m(detour->points_m, corner_m), 0.6) << "the gap is 1.6 m wide";
  for (const Eigen::Vector2d& point_m : detour->points_m) EXPECT_LT(point_m.y(), 1.5);
}

TEST(BranchDetour, IsNoneWhereNothingLeadsPast) {
  const SeenScan seen =
      scan_of({{{-1.0, 2.0}, {9.0, 2.2}}, {{-1.0, -2.2}, {9.0, -2.0}}, {{3.0, -2.0}, {3.5, 2.0}}});
  EXPECT_FALSE(detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, floor_with({}), {}));
}

TEST(BranchDetour, KeepsOutOfNoGoZones) {
  const SeenScan seen =
      scan_of({{{-1.0, 2.0}, {9.0, 2.2}}, {{-1.0, -2.2}, {9.0, -2.0}}, {{3.0, -1.9}, {3.5, 0.4}}});
  const auto wet = floor_with(
      {{"wet", {{4.0, 0.6}, {4.6, 0.6}, {4.6, 1.2}, {4.0, 1.2}}, planning::ZoneKind::kNoGo, 0.0}});
  const auto detour = detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, wet, {});
  EXPECT_FALSE(detour && least_distance_m(detour->points_m, {4.3, 0.9}) < 0.5);
  const auto all = floor_with(
      {{"all", {{2.0, -2}, {2.4, -2}, {2.4, 2}, {2.0, 2}}, planning::ZoneKind::kNoGo, 0.0}});
  EXPECT_FALSE(detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, all, {}));
}

// The zone is beside the route, in the gap.
TEST(BranchDetour, DrivesNoOneWayZoneAgainstItsHeading) {
  const SeenScan seen =
      scan_of({{{-1.0, 2.0}, {9.0, 2.2}}, {{-1.0, -2.2}, {9.0, -2.0}}, {{3.0, -1.9}, {3.5, 0.4}}});
  for (const double heading_rad : {0.0, std::numbers::pi}) {
    const auto aisle = floor_with({{"aisle",
                                    {{2.5, 0.3}, {4.0, 0.3}, {4.0, 2}, {2.5, 2}},
                                    planning::ZoneKind::kOneWay,
                                    heading_rad}});
    EXPECT_EQ(detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, aisle, {}).has_value(),
              heading_rad == 0.0);
  }
}

// Nothing is in view: two lines beside the robot serve as walls.
TEST(BranchDetour, FollowsAVirtualDiagramWhereNothingIsInSight) {
  const SeenScan seen = scan_of({});
  for (const topomap::MapBranch& branch : branches_of(seen, {}).branches) {
    EXPECT_TRUE(branch.is_virtual);
  }
  const auto detour = detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, floor_with({}), {});
  ASSERT_TRUE(detour);
  EXPECT_TRUE(detour->is_virtual);
  for (const Eigen::Vector2d& point_m : detour->points_m) EXPECT_NEAR(point_m.y(), 0.0, 0.1);
}

TEST(BranchDetour, FollowsAVirtualDiagramBesideOneGroup) {
  const SeenScan seen = scan_of({{{2.5, -1.4}, {3.1, -0.1}}});
  const auto detour = detour_along_branches(seen, kAhead, {0.0, 0.0}, {}, floor_with({}), {});
  ASSERT_TRUE(detour);
  EXPECT_TRUE(detour->is_virtual);
  EXPECT_GT(least_distance_m(detour->points_m, {2.5, -0.1}), 0.3);
}

// The laser is mounted to the left, and the robot is elsewhere on the map.
TEST(BranchDetour, BranchesAreInTheFrameOfTheMap) {
  SeenScan seen = scan_of({{{-1.0, 1.0}, {9.0, 1.2}}, {{-1.0, -1.2}, {9.0, -1.0}}});
  seen.T_robot_laser = {0.2, 0.0, 0.0};
  seen.T_map_robot = {5.0, 6.0, std::numbers::pi / 2};
  const topomap::GlobalMap graph = branches_of(seen, {});
  ASSERT_FALSE(graph.branches.empty());
  for (const topomap::BranchPoint& p : graph.branches.front().points) {
    EXPECT_NEAR(p.position_m.x(), 5.0, 0.1);
    EXPECT_GT(p.position_m.y(), 6.0);
  }
}

}  // namespace
}  // namespace topogeo::navigation
