#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/planning/route_planner.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "floor_views.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;
using test::corridor;
using test::Floor;
using test::view;

// A drive over a floor, stop by stop, with scans half a metre apart between the stops.
class LinkedDrive {
 public:
  explicit LinkedDrive(Floor floor) : floor_(std::move(floor)) {}

  /// Drives straight to a stop and makes its map; the map is empty when the laser is covered.
  void stop_at(const Pose2& pose, bool covered = false) {
    LocalMap map = covered ? LocalMap{} : view(floor_, pose);
    map.id = static_cast<std::uint32_t>(maps_.size());
    if (!maps_.empty()) {
      const Pose2 last = stops_.back().T_map_robot;
      const Eigen::Vector2d along_m = pose.position_m() - last.position_m();
      const int scans = static_cast<int>(along_m.norm() / 0.5);
      for (int k = 1; k < scans; ++k) {
        const Eigen::Vector2d at_m = last.position_m() + static_cast<double>(k) / scans * along_m;
        TrackedScan scan;
        scan.T_stop_robot = between(last, {at_m.x(), at_m.y(), pose.theta_rad});
        map.track.push_back(scan);
      }
    }
    maps_.push_back(map);
    stops_.push_back({map.id, 0, pose, Eigen::Matrix3d::Zero()});
  }

  /// Drives along y = 0, with a stop each metre.
  void along_x(int from_m, int to_m, bool covered = false) {
    const int step = from_m <= to_m ? 1 : -1;
    const double heading_rad = step > 0 ? 0.0 : std::numbers::pi;
    for (int x = from_m; x != to_m + step; x += step) {
      stop_at({static_cast<double>(x), 0, heading_rad}, covered);
    }
  }

  [[nodiscard]] GlobalMap map() const {
    GlobalMapBuilder builder;
    builder.rebuild(maps_, stops_);
    return builder.snapshot(1);
  }

  std::vector<LocalMap> maps_;
  std::vector<StopPose> stops_;

 private:
  Floor floor_;
};

std::vector<MapBranch> links(const GlobalMap& map) {
  std::vector<MapBranch> found;
  std::ranges::copy_if(map.branches, std::back_inserter(found), &MapBranch::is_virtual);
  return found;
}

const MapNode& node(const GlobalMap& map, std::uint32_t id) {
  return *std::ranges::find(map.nodes, id, &MapNode::id);
}

void expect_linked_well(const GlobalMap& map) {
  for (std::size_t i = 1; i < map.nodes.size(); ++i) {
    EXPECT_LT(map.nodes[i - 1].id, map.nodes[i].id);
  }
  for (std::size_t i = 1; i < map.branches.size(); ++i) {
    EXPECT_LT(map.branches[i - 1].id, map.branches[i].id);
  }
  for (const MapBranch& branch : map.branches) {
    ASSERT_NE(std::ranges::find(map.nodes, branch.node_a, &MapNode::id), map.nodes.end());
    ASSERT_NE(std::ranges::find(map.nodes, branch.node_b, &MapNode::id), map.nodes.end());
    ASSERT_GE(branch.points.size(), 2U);
    EXPECT_EQ(branch.points.front().position_m, node(map, branch.node_a).position_m);
    EXPECT_EQ(branch.points.back().position_m, node(map, branch.node_b).position_m);
    for (std::size_t i = 1; i < branch.points.size(); ++i) {
      const double step_m = (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
      EXPECT_LT(step_m, 0.8);
      EXPECT_GT(step_m, 0.0);
    }
  }
}

// The laser sees 8 m ahead: covered from x = 4 to 21, it sees nothing between 11 and 22.
LinkedDrive covered_in_the_middle() {
  LinkedDrive drive(corridor(30));
  drive.along_x(0, 3);
  drive.along_x(4, 21, true);
  drive.along_x(22, 29);
  return drive;
}

TEST(VirtualLink, JoinsWhatACoveredLaserLeftApart) {
  const GlobalMap map = covered_in_the_middle().map();
  expect_linked_well(map);
  ASSERT_EQ(links(map).size(), 1U);
  const MapBranch link = links(map)[0];
  // Between the two ends of the seen parts, along the driven path.
  EXPECT_NEAR(node(map, link.node_a).position_m.x(), 11.0, 0.3);
  EXPECT_NEAR(node(map, link.node_b).position_m.x(), 22.0, 0.3);
  EXPECT_EQ(map.branches.size(), 3U);
  EXPECT_EQ(map.nodes.size(), 4U);
  EXPECT_EQ(link.observations, 0U);
  EXPECT_GE(link.id, 1U << 31U);
  for (const BranchPoint& p : link.points) EXPECT_NEAR(p.position_m.y(), 0.0, 0.1);
  // The stops near the middle saw nothing.
  EXPECT_EQ(link.points[link.points.size() / 2].clearance_m, 0.0);
}

TEST(VirtualLink, ClearanceIsToTheNearestPointThatEitherStopSaw) {
  // Scan points without branches: the walls are known, but nothing joins the parts.
  LinkedDrive drive(corridor(30));
  drive.along_x(0, 3);
  Floor bare = corridor(30);
  bare.branches.clear();
  for (int x = 4; x <= 21; ++x) {
    drive.stop_at({static_cast<double>(x), 0.25, 0}, true);
    drive.maps_.back().points = view(bare, {static_cast<double>(x), 0.25, 0}).points;
  }
  drive.along_x(22, 29);
  const std::vector<MapBranch> found = links(drive.map());
  ASSERT_EQ(found.size(), 1U);
  const BranchPoint middle = found[0].points[found[0].points.size() / 2];
  EXPECT_NEAR(middle.position_m.y(), 0.25, 1e-6);
  EXPECT_NEAR(middle.clearance_m, 0.75, 0.02);
}

TEST(VirtualLink, FollowsTheDrivenWayAndMeetsTheMiddleOfABranch) {
  // Out of a corridor by a side door with the laser covered, round a corner, into another corridor.
  //
  //   a |=======================|      y = 0, seen from x = 0 to 20
  //               :
  //               '......|=======|     y = -10, seen from x = 20 to 30
  Floor floor = corridor(20);
  floor.walls.insert(floor.walls.end(), {{{20, -11}, {30, -11}}, {{20, -9}, {30, -9}}});
  floor.branches.push_back({{20, -10}, {30, -10}, 1.0});
  LinkedDrive drive(floor);
  drive.along_x(0, 19);
  drive.along_x(19, 10);
  for (int y = -1; y >= -10; --y) {
    drive.stop_at({10.0, static_cast<double>(y), -std::numbers::pi / 2.0}, true);
  }
  for (int x = 11; x <= 20; ++x) drive.stop_at({static_cast<double>(x), -10.0, 0}, true);
  for (int x = 21; x <= 29; ++x) drive.stop_at({static_cast<double>(x), -10.0, 0});
  const GlobalMap map = drive.map();
  expect_linked_well(map);
  ASSERT_EQ(links(map).size(), 1U);
  const MapBranch link = links(map)[0];
  const MapNode& start = node(map, link.node_a);
  EXPECT_EQ(start.kind, NodeKind::kVirtual);
  EXPECT_NEAR(start.position_m.x(), 10.0, 0.3);
  EXPECT_NEAR(start.position_m.y(), 0.0, 0.1);
  for (const BranchPoint& p : link.points) {
    const double from_down_m = std::fabs(p.position_m.x() - 10.0);
    const double from_along_m = std::fabs(p.position_m.y() + 10.0);
    EXPECT_LT(std::min(from_down_m, from_along_m), 0.3) << p.position_m.transpose();
  }
  // The corridor is now in two halves, and one of them keeps its name.
  EXPECT_EQ(std::ranges::count_if(map.branches,
                                  [](const MapBranch& b) {
                                    return !b.is_virtual &&
                                           std::fabs(b.points.front().position_m.y()) < 0.5;
                                  }),
            2);
}

TEST(VirtualLink, IsTakenByARouteThoughItsClearanceIsUnknown) {
  const GlobalMap map = covered_in_the_middle().map();
  const planning::PlanResult result = planning::plan(map, {1, 0}, {28, 0});
  ASSERT_TRUE(result.found()) << result.reason;
  EXPECT_THAT(result.route.branch_ids, testing::Contains(links(map)[0].id));
  EXPECT_NEAR(result.route.length_m, 27.0, 0.5);
  // A robot may start in the middle of the gap.
  EXPECT_TRUE(planning::plan(map, {16, 0}, {28, 0}).found());
}

TEST(VirtualLink, IsNotMadeWhereLocalMapsOverlap) {
  LinkedDrive whole(corridor(30));
  whole.along_x(0, 29);
  EXPECT_TRUE(links(whole.map()).empty());
  // The view from 16 reaches to where the view from 22 begins.
  LinkedDrive short_cover(corridor(30));
  short_cover.along_x(0, 16);
  short_cover.along_x(17, 21, true);
  short_cover.along_x(22, 29);
  const GlobalMap map = short_cover.map();
  EXPECT_TRUE(links(map).empty());
  EXPECT_EQ(map.branches.size(), 1U);
}

TEST(VirtualLink, GoesWhenLaterStopsSeeWhatJoinsTheParts) {
  LinkedDrive drive = covered_in_the_middle();
  ASSERT_EQ(links(drive.map()).size(), 1U);
  drive.along_x(28, 2);
  const GlobalMap map = drive.map();
  EXPECT_TRUE(links(map).empty());
  EXPECT_EQ(map.branches.size(), 1U);
}

TEST(VirtualLink, IsMadeOnceHoweverOftenTheWayIsDriven) {
  LinkedDrive drive = covered_in_the_middle();
  const GlobalMap once = drive.map();
  drive.along_x(28, 22);
  drive.along_x(21, 4, true);
  drive.along_x(3, 0);
  const GlobalMap twice = drive.map();
  ASSERT_EQ(links(twice).size(), 1U);
  EXPECT_EQ(links(twice)[0].id, links(once)[0].id);
  // On its way back the robot saw down to x = 14 before the laser was covered.
  EXPECT_NEAR(node(twice, links(twice)[0].node_b).position_m.x(), 14.0, 0.3);
}

TEST(VirtualLink, NeedsStopsThatFollowEachOther) {
  // The robot was carried: the ids of the maps have a gap.
  LinkedDrive drive(corridor(30));
  drive.along_x(0, 3);
  drive.along_x(22, 29);
  ASSERT_EQ(links(drive.map()).size(), 1U);
  for (std::size_t i = 4; i < drive.maps_.size(); ++i) ++drive.maps_[i].id;
  EXPECT_TRUE(links(drive.map()).empty());
}

TEST(VirtualLink, StaysShortEnoughForAMessage) {
  // 2 km unseen.
  LinkedDrive drive(corridor(2030));
  drive.along_x(0, 3);
  drive.along_x(4, 2009, true);
  drive.along_x(2010, 2020);
  const std::vector<MapBranch> found = links(drive.map());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_GT(found[0].points.size(), 500U);
  EXPECT_LE(found[0].points.size(), 2048U);
}

TEST(VirtualLink, IsTheSameBuiltStepByStepAndAnew) {
  const LinkedDrive drive = covered_in_the_middle();
  GlobalMapBuilder one_by_one;
  for (std::size_t i = 0; i < drive.maps_.size(); ++i) {
    one_by_one.integrate(drive.maps_[i], drive.stops_[i].T_map_robot);
    (void)one_by_one.snapshot(0);
  }
  GlobalMapBuilder anew;
  anew.integrate(drive.maps_[0], geometry::Pose2{5, 5, 1});
  anew.rebuild(drive.maps_, drive.stops_);
  const GlobalMap a = one_by_one.snapshot(1);
  const GlobalMap b = anew.snapshot(1);
  ASSERT_EQ(a.branches.size(), b.branches.size());
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) EXPECT_EQ(a.nodes[i].id, b.nodes[i].id);
  for (std::size_t i = 0; i < a.branches.size(); ++i) {
    EXPECT_EQ(a.branches[i].id, b.branches[i].id);
    EXPECT_EQ(a.branches[i].is_virtual, b.branches[i].is_virtual);
    ASSERT_EQ(a.branches[i].points.size(), b.branches[i].points.size());
    for (std::size_t k = 0; k < a.branches[i].points.size(); ++k) {
      EXPECT_EQ(a.branches[i].points[k].position_m, b.branches[i].points[k].position_m);
      EXPECT_EQ(a.branches[i].points[k].clearance_m, b.branches[i].points[k].clearance_m);
    }
  }
}

TEST(VirtualLink, RefusesATrackThatIsNotFinite) {
  LocalMap map = view(corridor(6), {0.5, 0, 0});
  map.track.resize(1);
  map.track[0].T_stop_robot.x_m = std::nan("");
  GlobalMapBuilder builder;
  EXPECT_THROW(builder.integrate(map, geometry::Pose2{}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::topomap
