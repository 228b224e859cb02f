#include "topogeo/topomap/local_map.hpp"

#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "topogeo/topomap/node_kind_name.hpp"

namespace topogeo::topomap {
namespace {

LocalMap sample() {
  LocalMap map;
  map.robot_id = "r1";
  map.id = 4;
  map.stamp_ns = 5;
  map.T_robot_laser = {0.1, 0.0, 0.0};
  map.points = {{1.0F, 2.0F}, {3.0F, 4.0F}};
  map.nodes = {{0, NodeKind::kReal, {1.0, 1.0}, 0.8, {0, 1, 2}, true},
               {1, NodeKind::kFictitious, {2.0, 1.0}, 0.7, {0, 1}, true}};
  LocalBranch branch;
  branch.node_b = 1;
  branch.points = {{{1.0, 1.0}, 0.8}, {{2.0, 1.0}, 0.7}};
  map.branches = {branch};
  return map;
}

TEST(NodeKindName, IsAWordForEachKindAndBack) {
  for (int number = 0; number < 6; ++number) {
    const auto kind = static_cast<NodeKind>(number);
    EXPECT_EQ(node_kind_of(name_of(kind)), kind);
  }
  EXPECT_EQ(name_of(NodeKind::kHallCorridor), "hall_corridor");
  EXPECT_EQ(name_of(static_cast<NodeKind>(6)), "unknown");
  EXPECT_FALSE(node_kind_of("unknown"));
  EXPECT_FALSE(node_kind_of("Door"));
}

TEST(ContentHash, ChangesWithEverythingThatAMatchDependsOn) {
  const std::vector<std::function<void(LocalMap&)>> changes = {
      [](LocalMap& m) { m.id = 5; },
      [](LocalMap& m) { m.T_robot_laser.x_m = 0.2; },
      [](LocalMap& m) { m.T_robot_laser.y_m = 0.2; },
      [](LocalMap& m) { m.T_robot_laser.theta_rad = 0.2; },
      [](LocalMap& m) { m.points[1].x_m = 3.0001F; },
      [](LocalMap& m) { m.points[1].y_m = 4.0001F; },
      [](LocalMap& m) { m.points.pop_back(); },
      [](LocalMap& m) { std::swap(m.points[0], m.points[1]); },
      [](LocalMap& m) { m.nodes[0].kind = NodeKind::kDoor; },
      [](LocalMap& m) { m.nodes[0].position_m.y() += 1e-12; },
      [](LocalMap& m) { m.nodes[1].clearance_m = 0.71; },
      [](LocalMap& m) { m.nodes.pop_back(); },
      [](LocalMap& m) { m.branches[0].node_b = 0; },
      [](LocalMap& m) { m.branches[0].points[1].position_m.x() = 2.5; },
      [](LocalMap& m) { m.branches[0].points[1].clearance_m = 0.75; },
      [](LocalMap& m) { m.branches.clear(); },
      [](LocalMap& m) { m.branches[0].is_virtual = true; },
      [](LocalMap& m) { m.branches[0].in_main_graph = false; },
      [](LocalMap& m) { m.branches[0].confirmed = false; },
      [](LocalMap& m) { m.nodes[0].in_main_graph = false; },
  };
  std::set<std::uint64_t> hashes{content_hash(sample())};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    LocalMap map = sample();
    changes[i](map);
    EXPECT_TRUE(hashes.insert(content_hash(map)).second) << "change " << i;
  }
}

TEST(ContentHash, DoesNotDependOnWhenOrByWhomTheMapWasMade) {
  LocalMap map = sample();
  map.robot_id = "r2";
  map.stamp_ns = 99;
  map.sequence = 7;
  map.T_odom_robot = {1, 2, 3};
  map.track.emplace_back();
  EXPECT_EQ(content_hash(map), content_hash(sample()));
}

TEST(ContentHash, IsKnownOfTheMapWithAnotherNumber) {
  EXPECT_EQ(content_hash(sample(), sample().id), content_hash(sample()));
  EXPECT_EQ(content_hash(sample(), 77), content_hash(numbered(sample(), 77, false)));
}

TEST(ContentHash, TellsApartWhereOneListEndsAndTheNextBegins) {
  // Two branches of two points, against one of four with the same numbers in the same order.
  LocalMap one;
  one.branches.resize(2);
  one.branches[0].points = {{{0, 0}, 0}, {{0, 0}, 0}};
  one.branches[1].points = {{{0, 0}, 0}};
  LocalMap other;
  other.branches.resize(2);
  other.branches[0].points = {{{0, 0}, 0}};
  other.branches[1].points = {{{0, 0}, 0}, {{0, 0}, 0}};
  EXPECT_NE(content_hash(one), content_hash(other));
}

}  // namespace
}  // namespace topogeo::topomap
