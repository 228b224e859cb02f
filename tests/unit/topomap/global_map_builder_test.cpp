#include "topogeo/topomap/global_map_builder.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "floor_views.hpp"

namespace topogeo::topomap {
namespace {

using geometry::Pose2;
using test::corridor;
using test::Floor;
using test::loop_of_corridors;
using test::room_behind_door;
using test::t_junction;
using test::view;

constexpr double kQuarter = std::numbers::pi / 2.0;

std::vector<Pose2> drive(const Eigen::Vector2d& from_m, double heading_rad, double length_m,
                         double step_m = 1.0) {
  std::vector<Pose2> poses;
  for (double s = 0.0; s <= length_m + 1e-9; s += step_m) {
    poses.push_back({from_m.x() + s * std::cos(heading_rad), from_m.y() + s * std::sin(heading_rad),
                     heading_rad});
  }
  return poses;
}

std::vector<Pose2> round_trip() {
  std::vector<Pose2> poses;
  for (const auto& leg : {drive({1, 1}, 0.0, 21), drive({23, 1}, kQuarter, 13),
                          drive({23, 15}, std::numbers::pi, 21), drive({1, 15}, -kQuarter, 13)}) {
    poses.insert(poses.end(), leg.begin(), leg.end());
  }
  return poses;
}

// Integrates the view from each pose, with poses known to `error_m` (and a tenth of it in rad).
void explore(GlobalMapBuilder& builder, const Floor& floor, const std::vector<Pose2>& poses,
             double error_m = 0.0) {
  std::mt19937 random(7);
  const auto noise = [&] {
    return error_m * (static_cast<double>(random()) / 4294967296.0 * 2.0 - 1.0);
  };
  for (const Pose2& pose : poses) {
    const LocalMap map = view(floor, pose);
    builder.integrate(map, pose * Pose2{noise(), noise(), 0.1 * noise()});
  }
}

double length_m(const MapBranch& branch) {
  double length = 0.0;
  for (std::size_t i = 1; i < branch.points.size(); ++i) {
    length += (branch.points[i].position_m - branch.points[i - 1].position_m).norm();
  }
  return length;
}

double length_m(const GlobalMap& map) {
  double length = 0.0;
  for (const MapBranch& b : map.branches) length += length_m(b);
  return length;
}

const MapNode* node_near(const GlobalMap& map, const Eigen::Vector2d& point_m, double radius_m) {
  for (const MapNode& n : map.nodes) {
    if ((n.position_m - point_m).norm() < radius_m) return &n;
  }
  return nullptr;
}

std::size_t degree(const GlobalMap& map, std::uint32_t node) {
  std::size_t count = 0;
  for (const MapBranch& b : map.branches) {
    count +=
        static_cast<std::size_t>(b.node_a == node) + static_cast<std::size_t>(b.node_b == node);
  }
  return count;
}

// Distance from a point to the nearest branch point of the map.
double distance_to_map_m(const GlobalMap& map, const Eigen::Vector2d& point_m) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const MapBranch& b : map.branches) {
    for (const BranchPoint& p : b.points) {
      nearest = std::min(nearest, (p.position_m - point_m).norm());
    }
  }
  return nearest;
}

void expect_well_formed(const GlobalMap& map) {
  std::set<std::uint32_t> nodes;
  for (const MapNode& n : map.nodes) {
    EXPECT_TRUE(nodes.insert(n.id).second);
    EXPECT_GE(n.observations, 1U);
    EXPECT_GE(degree(map, n.id), 1U) << "node " << n.id;
  }
  std::set<std::uint32_t> branches;
  for (const MapBranch& b : map.branches) {
    EXPECT_TRUE(branches.insert(b.id).second);
    EXPECT_TRUE(nodes.contains(b.node_a) && nodes.contains(b.node_b));
    ASSERT_GE(b.points.size(), 2U);
    for (std::size_t i = 1; i < b.points.size(); ++i) {
      EXPECT_LT((b.points[i].position_m - b.points[i - 1].position_m).norm(), 0.8);
    }
  }
  EXPECT_TRUE(std::ranges::is_sorted(map.nodes, {}, &MapNode::id));
  EXPECT_TRUE(std::ranges::is_sorted(map.branches, {}, &MapBranch::id));
}

void expect_same(const GlobalMap& a, const GlobalMap& b) {
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.branches.size(), b.branches.size());
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    EXPECT_EQ(a.nodes[i].id, b.nodes[i].id);
    EXPECT_EQ(a.nodes[i].kind, b.nodes[i].kind);
    EXPECT_EQ(a.nodes[i].position_m, b.nodes[i].position_m);
    EXPECT_EQ(a.nodes[i].clearance_m, b.nodes[i].clearance_m);
    EXPECT_EQ(a.nodes[i].observations, b.nodes[i].observations);
  }
  for (std::size_t i = 0; i < a.branches.size(); ++i) {
    EXPECT_EQ(a.branches[i].id, b.branches[i].id);
    ASSERT_EQ(a.branches[i].points.size(), b.branches[i].points.size());
    for (std::size_t k = 0; k < a.branches[i].points.size(); ++k) {
      EXPECT_EQ(a.branches[i].points[k].position_m, b.branches[i].points[k].position_m);
      EXPECT_EQ(a.branches[i].points[k].clearance_m, b.branches[i].points[k].clearance_m);
    }
  }
}

TEST(GlobalMapBuilder, IsEmptyBeforeTheFirstView) {
  const GlobalMap map = GlobalMapBuilder().snapshot(3);
  EXPECT_EQ(map.version, 3U);
  EXPECT_TRUE(map.nodes.empty());
  EXPECT_TRUE(map.branches.empty());
}

TEST(GlobalMapBuilder, FirstMapIsTheFirstView) {
  GlobalMapBuilder builder;
  explore(builder, corridor(6), {{0.5, 0, 0}});
  const GlobalMap map = builder.snapshot(1);
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 1U);
  EXPECT_NEAR(length_m(map), 5.5, 0.4);
  for (const BranchPoint& p : map.branches[0].points) {
    EXPECT_NEAR(p.position_m.y(), 0.0, 0.03);
    EXPECT_NEAR(p.clearance_m, 1.0, 1e-5);
  }
}

TEST(GlobalMapBuilder, ManyShiftedViewsOfACorridorGiveOneBranch) {
  GlobalMapBuilder builder;
  explore(builder, corridor(30), drive({0, 0}, 0.0, 29, 0.5), 0.1);
  const GlobalMap map = builder.snapshot(1);
  expect_well_formed(map);
  ASSERT_EQ(map.branches.size(), 1U);
  ASSERT_EQ(map.nodes.size(), 2U);
  for (const MapNode& n : map.nodes) EXPECT_EQ(n.kind, NodeKind::kFictitious);
  EXPECT_NEAR(length_m(map), 30.0, 0.6);
  for (const BranchPoint& p : map.branches[0].points) EXPECT_NEAR(p.position_m.y(), 0.0, 0.1);
}

TEST(GlobalMapBuilder, JunctionIsOneRealNodeWithThreeBranches) {
  GlobalMapBuilder builder;
  auto poses = drive({0, 0}, 0.0, 19);
  for (const Pose2& pose : drive({10, 0}, kQuarter, 7)) poses.push_back(pose);
  explore(builder, t_junction(), poses, 0.05);
  const GlobalMap map = builder.snapshot(1);
  expect_well_formed(map);
  EXPECT_EQ(map.branches.size(), 3U);
  const MapNode* junction = node_near(map, {10, 0}, 0.15);
  ASSERT_NE(junction, nullptr);
  EXPECT_EQ(junction->kind, NodeKind::kReal);
  EXPECT_EQ(degree(map, junction->id), 3U);
  EXPECT_GT(junction->observations, 5U);
  EXPECT_NEAR(junction->clearance_m, 1.0, 1e-9);
}

TEST(GlobalMapBuilder, EquivalentNodesMergeToTheMeanOfPositionAndClearance) {
  // Three views of the same junction, 0.1 m apart and with clearances 1.0, 1.1, 1.2.
  GlobalMapBuilder builder;
  const Pose2 pose{8, 0, 0};
  for (const double shift : {0.0, 0.1, 0.2}) {
    LocalMap map = view(t_junction(), pose);
    for (LocalNode& n : map.nodes) {
      if (n.kind == NodeKind::kReal) n.clearance_m = 1.0 + shift;
    }
    builder.integrate(map, Pose2{8 + shift, 0, 0});
  }
  const GlobalMap map = builder.snapshot(1);
  const MapNode* junction = node_near(map, {10.1, 0}, 1e-9);
  ASSERT_NE(junction, nullptr);
  EXPECT_EQ(junction->observations, 3U);
  EXPECT_NEAR(junction->clearance_m, 1.1, 1e-12);
}

TEST(GlobalMapBuilder, NearNodesCollapseIntoOne) {
  // Fig. 8.10: two junctions 0.3 m apart, one for each arm of a crossing.
  Floor floor{{},
              {{{0, 0}, {5, 0}},
               {{5, 0}, {5.3, 0}},
               {{5.3, 0}, {10, 0}},
               {{5, 0}, {5, 4}},
               {{5.3, 0}, {5.3, -4}}},
              {{{5, 0}, 1.0, NodeKind::kReal}, {{5.3, 0}, 1.1, NodeKind::kReal}}};
  GlobalMapBuilder builder;
  explore(builder, floor, drive({2, 0}, 0.0, 2));
  const GlobalMap map = builder.snapshot(1);
  expect_well_formed(map);
  std::size_t real = 0;
  for (const MapNode& n : map.nodes) {
    if (n.kind != NodeKind::kReal) continue;
    ++real;
    EXPECT_EQ(degree(map, n.id), 4U);
  }
  EXPECT_EQ(real, 1U);
  EXPECT_EQ(map.branches.size(), 4U);
}

TEST(GlobalMapBuilder, DoorSeenOpenLaterAddsItsBranchAndNode) {
  GlobalMapBuilder builder;
  explore(builder, room_behind_door(false), drive({0, 0}, 0.0, 11));
  const GlobalMap closed = builder.snapshot(1);
  ASSERT_EQ(closed.branches.size(), 1U);
  EXPECT_GT(distance_to_map_m(closed, {6, 2}), 1.5);

  // The robot passes it once more and looks in; most views of the corridor before showed a closed
  // door.
  explore(builder, room_behind_door(true), drive({1, 0}, 0.0, 4));
  explore(builder, room_behind_door(true), drive({6, 0}, kQuarter, 2, 0.5));
  const GlobalMap open = builder.snapshot(2);
  expect_well_formed(open);
  EXPECT_LT(distance_to_map_m(open, {6, 2.5}), 0.2);
  const MapNode* junction = node_near(open, {6, 0}, 0.3);
  ASSERT_NE(junction, nullptr);
  EXPECT_EQ(degree(open, junction->id), 3U);
  const MapNode* door = node_near(open, {6, 1.1}, 0.2);
  ASSERT_NE(door, nullptr);
  EXPECT_EQ(door->kind, NodeKind::kDoor);
  EXPECT_EQ(degree(open, door->id), 2U);
}

TEST(GlobalMapBuilder, FalseBranchSeenOnceIsOutvoted) {
  // Fig. 8.8: a person stood in the corridor; one view has branches round the person.
  Floor person = corridor(12);
  person.branches.push_back({{5, 0}, {6, 0.6}, 0.4});
  person.branches.push_back({{6, 0.6}, {7, 0}, 0.4});
  GlobalMapBuilder builder;
  explore(builder, person, {{2, 0, 0}});
  EXPECT_LT(distance_to_map_m(builder.snapshot(1), {6, 0.6}), 0.2);
  explore(builder, corridor(12), drive({0, 0}, 0.0, 5));
  const GlobalMap map = builder.snapshot(2);
  EXPECT_EQ(map.branches.size(), 1U);
  EXPECT_GT(distance_to_map_m(map, {6, 0.6}), 0.5);
}

TEST(GlobalMapBuilder, BranchOutOfViewIsNotOutvoted) {
  // Views in other directions contain no information about the side corridor.
  GlobalMapBuilder builder;
  explore(builder, t_junction(), {{10, 0, kQuarter}, {10, 0, 0}});
  explore(builder, t_junction(), drive({12, 0}, 0.0, 7, 0.25));
  EXPECT_LT(distance_to_map_m(builder.snapshot(1), {10, 4}), 0.2);
}

TEST(GlobalMapBuilder, LoopOfCorridorsIsOneCycle) {
  GlobalMapBuilder builder;
  explore(builder, loop_of_corridors(), round_trip(), 0.05);
  const GlobalMap map = builder.snapshot(1);
  expect_well_formed(map);
  // One connected cycle: as many branches as nodes, every node with two ends.
  EXPECT_EQ(map.branches.size(), map.nodes.size());
  for (const MapNode& n : map.nodes) EXPECT_EQ(degree(map, n.id), 2U);
  EXPECT_NEAR(length_m(map), 72.0, 2.5);
}

TEST(GlobalMapBuilder, VirtualElementsAndThoseOffTheMainGraphAreNotFused) {
  LocalMap map = view(corridor(6), {0.5, 0, 0});
  GlobalMapBuilder builder;
  for (LocalBranch& b : map.branches) b.is_virtual = true;
  builder.integrate(map, geometry::Pose2{});
  for (LocalBranch& b : map.branches) {
    b.is_virtual = false;
    b.in_main_graph = false;
  }
  builder.integrate(map, geometry::Pose2{});
  EXPECT_TRUE(builder.snapshot(1).branches.empty());
}

TEST(GlobalMapBuilder, RebuildEqualsIntegratingOneByOne) {
  std::vector<LocalMap> maps;
  std::vector<StopPose> stops;
  GlobalMapBuilder one_by_one;
  for (const Pose2& pose : round_trip()) {
    maps.push_back(view(loop_of_corridors(), pose));
    StopPose& stop = stops.emplace_back();
    stop.T_map_robot = pose * Pose2{0.03, -0.02, 0.01};
    one_by_one.integrate(maps.back(), stop.T_map_robot);
    // A snapshot in between must not change what follows.
    if (maps.size() % 10 == 0) (void)one_by_one.snapshot(0);
  }
  GlobalMapBuilder rebuilt;
  explore(rebuilt, corridor(5), {{0, 0, 0}});
  rebuilt.rebuild(maps, stops);
  expect_same(one_by_one.snapshot(1), rebuilt.snapshot(1));
}

TEST(GlobalMapBuilder, ElementsKeepTheirIdsWhenMoreIsSeen) {
  GlobalMapBuilder builder;
  explore(builder, t_junction(), drive({0, 0}, 0.0, 8), 0.03);
  const GlobalMap before = builder.snapshot(1);
  explore(builder, t_junction(), drive({9, 0}, 0.0, 9), 0.03);
  explore(builder, t_junction(), drive({10, 0}, kQuarter, 5), 0.03);
  const GlobalMap after = builder.snapshot(2);
  const MapNode* junction_before = node_near(before, {10, 0}, 0.2);
  const MapNode* junction_after = node_near(after, {10, 0}, 0.2);
  ASSERT_TRUE(junction_before != nullptr && junction_after != nullptr);
  EXPECT_EQ(junction_before->id, junction_after->id);
  for (const MapBranch& b : before.branches) {
    EXPECT_TRUE(std::ranges::any_of(after.branches, [&](const MapBranch& a) {
      return a.id == b.id;
    })) << b.id;
  }
}

TEST(GlobalMapBuilder, RefusesWhatItCannotPlace) {
  GlobalMapBuilder builder;
  const LocalMap map = view(corridor(6), {0.5, 0, 0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(builder.integrate(map, geometry::Pose2{nan, 0, 0}), std::invalid_argument);
  EXPECT_THROW(builder.integrate(map, geometry::Pose2{0, 0, nan}), std::invalid_argument);
  EXPECT_THROW(builder.integrate(map, geometry::Pose2{6000, 0, 0}), std::invalid_argument);
  LocalMap broken = map;
  broken.branches[0].points[1].position_m.x() = nan;
  EXPECT_THROW(builder.integrate(broken, geometry::Pose2{}), std::invalid_argument);
  EXPECT_THROW(builder.rebuild(std::vector<LocalMap>{map}, {}), std::invalid_argument);
  EXPECT_TRUE(builder.snapshot(1).branches.empty());
  EXPECT_NO_THROW(builder.integrate(LocalMap{}, geometry::Pose2{}));
}

TEST(GlobalMapConfig, NamesTheFieldOutOfRange) {
  GlobalMapConfig config;
  EXPECT_NO_THROW(check(config));
  config.keep_share = 1.5;
  try {
    GlobalMapBuilder builder(config);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::StrEq("key 'global_map.keep_share' = '1.5': expected "
                                             "number between 0.12 and 0.99"));
  }
}

TEST(GlobalMapConfig, NamesValuesThatDoNotFitEachOther) {
  GlobalMapConfig config;
  config.cell_m = 0.032;
  config.vote_radius_m = 0.3;  // more than eight cells
  EXPECT_THAT([&] { check(config); }, testing::ThrowsMessage<std::invalid_argument>(
                                          testing::HasSubstr("global_map.vote_radius_m")));
  config = {};
  config.bridge_share = 0.5;
  EXPECT_THAT([&] { check(config); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::AllOf(testing::HasSubstr("'global_map.keep_share' = '0.4'"),
                                 testing::HasSubstr("at least global_map.bridge_share = 0.5"))));
}

}  // namespace
}  // namespace topogeo::topomap
