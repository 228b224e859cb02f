#include "topogeo/exchange/route_network.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_floor.hpp"

namespace topogeo::exchange {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// A branch from (0, 0) along a quarter of a circle of 4 m, 2 m from every wall.
topomap::GlobalMap curve(double clearance_m) {
  topomap::GlobalMap map;
  map.nodes = {{1, topomap::NodeKind::kReal, {0.0, 0.0}, clearance_m, 1},
               {2, topomap::NodeKind::kReal, {4.0, 4.0}, clearance_m, 1}};
  topomap::MapBranch branch{5, 1, 2, false, 1, {}};
  constexpr int kSteps = 90;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = i * 3.14159265358979 / 2.0 / kSteps;
    branch.points.push_back({{4.0 * std::sin(angle), 4.0 - 4.0 * std::cos(angle)}, clearance_m});
  }
  branch.points.front().position_m = map.nodes[0].position_m;
  branch.points.back().position_m = map.nodes[1].position_m;
  map.branches = {branch};
  return map;
}

/// Largest distance of any point of the branch from the pieces.
double farthest(const topomap::MapBranch& branch, const RouteNetwork& network) {
  double most_m = 0.0;
  for (const topomap::BranchPoint& p : branch.points) {
    double nearest_m = 1e9;
    for (const NetworkPiece& piece : network.pieces) {
      const Eigen::Vector2d a = network.nodes[piece.from].position_m;
      const Eigen::Vector2d along = network.nodes[piece.to].position_m - a;
      const double t = std::clamp((p.position_m - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
      nearest_m = std::min(nearest_m, (p.position_m - a - t * along).norm());
    }
    most_m = std::max(most_m, nearest_m);
  }
  return most_m;
}

TEST(RouteNetwork, LeavesOutBendsWithinTheTolerance) {
  const topomap::GlobalMap map = curve(2.0);
  const RouteNetwork network = route_network(map, {}, nullptr, {});
  // A chord of a circle of 4 m stays within 0.1 m of it up to 0.45 rad, so there are at least four.
  EXPECT_GE(network.pieces.size(), 4U);
  EXPECT_LE(network.pieces.size(), 8U);
  EXPECT_LE(farthest(map.branches[0], network), 0.1 + 1e-9);
  for (const NetworkPiece& piece : network.pieces) {
    EXPECT_GE(piece.clearance_m, 1.9);
    EXPECT_LE(piece.clearance_m, 2.0);
    EXPECT_EQ(piece.branch, 5U);
  }
}

TEST(RouteNetwork, StaysNearTheBranchWhereItIsNarrow) {
  const topomap::GlobalMap map = curve(0.32);
  const RouteNetwork network = route_network(map, {}, nullptr, {});
  EXPECT_LE(farthest(map.branches[0], network), 0.02 + 1e-9);
  for (const NetworkPiece& piece : network.pieces) EXPECT_GE(piece.clearance_m, 0.3 - 1e-9);
}

TEST(RouteNetwork, LeavesOutWhatTheRobotIsTooWideForAndSaysSo) {
  const RouteNetwork network = route_network(sample_graph(), {}, nullptr, {});
  // Node 12 is on a stretch beyond the narrow one; the virtual branch is not written.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_six;
  for (const NetworkPiece& piece : network.pieces) {
    EXPECT_GE(piece.clearance_m, 0.3);
    if (piece.branch == 6U) of_six.emplace_back(piece.from, piece.to);
    EXPECT_NE(piece.branch, 8U);
  }
  ASSERT_EQ(of_six.size(), 2U);
  EXPECT_EQ(of_six[0].first, 2U);   // node 9
  EXPECT_EQ(of_six[1].second, 3U);  // node 12
  EXPECT_NE(of_six[0].second, of_six[1].first);
  EXPECT_THAT(network.notes, Contains(HasSubstr("1 branches are narrower")));
  EXPECT_THAT(network.notes, Contains(HasSubstr("1 virtual branches")));
}

TEST(RouteNetwork, ABranchWithoutKnownClearanceIsNotNarrow) {
  const topomap::GlobalMap map = curve(0.0);
  const RouteNetwork network = route_network(map, {}, nullptr, {});
  EXPECT_EQ(network.pieces.size(), route_network(curve(2.0), {}, nullptr, {}).pieces.size());
  EXPECT_LE(farthest(map.branches[0], network), 0.1 + 1e-9);
  EXPECT_THAT(network.notes, testing::ElementsAre(HasSubstr("1 branches have no known clearance")));
}

TEST(RouteNetwork, VirtualBranchesComeOnRequest) {
  const RouteNetwork network = route_network(sample_graph(), {}, nullptr, {0.3, 0.1, true});
  const auto is_eight = [](const NetworkPiece& piece) { return piece.branch == 8U; };
  EXPECT_TRUE(std::ranges::any_of(network.pieces, is_eight));
}

TEST(RouteNetwork, AVirtualBranchThatAloneJoinsPartsIsKept) {
  // The view ends between two halves of a curve.
  topomap::GlobalMap map = curve(2.0);
  map.nodes.push_back({3, topomap::NodeKind::kFictitious, {4.0, 6.0}, 1.0, 1});
  map.nodes.push_back({4, topomap::NodeKind::kReal, {4.0, 9.0}, 1.0, 1});
  map.branches.push_back({6, 3, 4, false, 1, {{{4.0, 6.0}, 1.0}, {{4.0, 9.0}, 1.0}}});
  map.branches.push_back({7, 2, 3, true, 1, {{{4.0, 4.0}, 1.0}, {{4.0, 6.0}, 1.0}}});
  map.branches.push_back({8, 1, 4, true, 1, {{{0.0, 0.0}, 1.0}, {{4.0, 9.0}, 1.0}}});
  const RouteNetwork network = route_network(map, {}, nullptr, {});
  const auto count = [&](std::uint32_t branch) {
    return std::ranges::count(network.pieces, std::optional(branch), &NetworkPiece::branch);
  };
  EXPECT_EQ(count(7), 1);
  EXPECT_EQ(count(8), 0);
  EXPECT_THAT(network.notes, Contains(HasSubstr("1 virtual branches kept, only they join parts")));
  EXPECT_THAT(network.notes, Contains(HasSubstr("1 virtual branches left out")));
}

TEST(RouteNetwork, PlacesHangOnTheNearestBranch) {
  const planning::FreeSpace space = sample_space();
  storage::MapDrawing drawing;
  drawing.places = sample_drawing().places;
  const auto& places = drawing.places;
  const RouteNetwork network = route_network(sample_graph(), drawing, &space, {});
  // The kitchen is node 9 itself; the room is joined to the node at (0, 0).
  EXPECT_EQ(network.nodes[2].place, 1U);
  const NetworkPiece& way = network.pieces.back();
  EXPECT_FALSE(way.branch);
  EXPECT_EQ(way.from, 0U);
  EXPECT_EQ(network.nodes[way.to].place, 0U);
  EXPECT_EQ(network.nodes[way.to].position_m, places[0].position_m);
}

TEST(RouteNetwork, APlaceBesideAnEdgeSplitsIt) {
  storage::MapDrawing drawing;
  drawing.places = {{"middle", {8.5, 1.2}}};
  const RouteNetwork network = route_network(sample_graph(), drawing, nullptr, {});
  const NetworkPiece& way = network.pieces.back();
  const Eigen::Vector2d at = network.nodes[way.from].position_m;
  EXPECT_NEAR(at.x(), 8.0, 1e-12);
  EXPECT_NEAR(at.y(), 1.2, 1e-12);
  std::size_t ends = 0;
  for (const NetworkPiece& piece : network.pieces) {
    ends += (piece.from == way.from) + (piece.to == way.from);
  }
  EXPECT_EQ(ends, 3U);
}

TEST(RouteNetwork, APlaceBehindAWallHasNoEdges) {
  planning::FreeSpace open = sample_space();
  planning::OccupancyGrid grid = open.grid();
  // A wall along y = -1.75, below all branches.
  for (std::int32_t column = 0; column < grid.frame().columns; ++column) {
    grid.set({column, 12}, planning::CellState::kOccupied);
  }
  const planning::FreeSpace space(std::move(grid));
  storage::MapDrawing drawing;
  drawing.places = {{"cellar", {0.0, -2.6}}};
  const RouteNetwork network = route_network(sample_graph(), drawing, &space, {});
  EXPECT_THAT(network.notes, Contains(HasSubstr("place 'cellar': no free path")));
  EXPECT_EQ(network.nodes.back().place, 0U);
  for (const NetworkPiece& piece : network.pieces) {
    EXPECT_NE(piece.from, network.nodes.size() - 1);
    EXPECT_NE(piece.to, network.nodes.size() - 1);
  }
}

TEST(RouteNetwork, WhatTheGridForbidsIsCountedOrLeftOut) {
  planning::OccupancyGrid grid = sample_space().grid();
  grid.set({60, 22}, planning::CellState::kOccupied);  // at (5.05, -0.75), on the lower branch
  const planning::FreeSpace space(std::move(grid));
  const RouteNetwork counted = route_network(sample_graph(), {}, &space, {});
  EXPECT_THAT(counted.notes, Contains(HasSubstr("1 of 8 edges")));
  EXPECT_EQ(counted.pieces.size(), 8U);
  const RouteNetwork free = route_network(sample_graph(), {}, &space, {.only_free = true});
  EXPECT_THAT(free.notes, Contains(HasSubstr("left out")));
  EXPECT_EQ(free.pieces.size(), 7U);
}

TEST(RouteNetwork, ZonesCloseLimitAndDirect) {
  storage::MapDrawing drawing;
  drawing.zones = sample_drawing().zones;
  // Across the first branch, beyond its bend.
  drawing.zones.push_back(
      {"barrier", {{3.0, -1.0}, {3.1, -1.0}, {3.1, 1.5}}, planning::ZoneKind::kNoGo, 0.0});
  const RouteNetwork network = route_network(sample_graph(), drawing, nullptr, {});
  EXPECT_THAT(network.notes, Contains(HasSubstr("1 edges left out, zones forbid them")));
  std::size_t of_one = 0;
  for (const NetworkPiece& piece : network.pieces) {
    of_one += piece.branch == 1U;
    if (piece.branch == 3U) {
      EXPECT_EQ(piece.rule.speed_mps, 0.35);
      EXPECT_TRUE(piece.rule.forward && piece.rule.backward);
    }
    if (piece.branch == 4U) {
      EXPECT_FALSE(piece.rule.forward);
      EXPECT_TRUE(piece.rule.backward);
      EXPECT_FALSE(piece.rule.speed_mps);
    }
  }
  EXPECT_EQ(of_one, 1U);
}

TEST(RouteNetwork, AOneWayZoneCanBeCrossed) {
  const std::vector<planning::DrawnZone> lane = {
      {"lane", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, planning::ZoneKind::kOneWay, 0.0}};
  const DrivingRule across = rule_between(lane, {0, -2}, {0, 2});
  EXPECT_TRUE(across.forward && across.backward);
  const DrivingRule against = rule_between(lane, {2, 0}, {-2, 0});
  EXPECT_FALSE(against.forward);
  EXPECT_TRUE(against.backward);
  EXPECT_TRUE(rule_between(lane, {3, -2}, {3, 2}).forward);
}

TEST(RouteNetwork, LoopsAreKeptUnlessTheyAreSmallerThanTheTolerance) {
  topomap::GlobalMap map = sample_graph();
  // Around a pillar, and a curl of some centimetres.
  map.branches = {{1, 2, 2, false, 1, {{{0, 0}, 1}, {{1, 0}, 1}, {{1, 1}, 1}, {{0, 0}, 1}}},
                  {2, 7, 7, false, 1, {{{4, 0.5}, 1}, {{4.05, 0.5}, 1}, {{4, 0.5}, 1}}}};
  const RouteNetwork network = route_network(map, {}, nullptr, {});
  ASSERT_EQ(network.pieces.size(), 3U);
  for (const NetworkPiece& piece : network.pieces) {
    EXPECT_EQ(piece.branch, 1U);
    EXPECT_NE(piece.from, piece.to);
  }
}

TEST(RouteNetwork, RefusesSettingsOutOfRange) {
  EXPECT_THROW(route_network(sample_graph(), {}, nullptr, {-0.1}), std::invalid_argument);
  EXPECT_THROW(route_network(sample_graph(), {}, nullptr, {0.3, 1.5}), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::exchange
