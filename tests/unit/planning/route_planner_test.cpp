#include "topogeo/planning/route_planner.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "branch_maps.hpp"

namespace topogeo::planning {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using topomap::GlobalMap;

//  3 ----11---- 4          two corridors 10 m apart, 20 m long, joined at both ends;
//  |            |          the west joint (12) is 0.4 m wide on each side, the east one (13) 1 m
//  12           13
//  |            |          nodes 7 and 8 lie apart
//  1 ----10---- 2     7 --14-- 8
GlobalMap ring() {
  GlobalMap map;
  add_map_node(map, 1, 0, 0);
  add_map_node(map, 2, 20, 0);
  add_map_node(map, 3, 0, 10);
  add_map_node(map, 4, 20, 10);
  add_map_node(map, 7, 30, 0);
  add_map_node(map, 8, 40, 0);
  add_map_branch(map, 10, 1, 2, {{10, 0}});
  add_map_branch(map, 11, 4, 3, {{10, 10}});
  add_map_branch(map, 12, 1, 3, {}, 0.4);
  add_map_branch(map, 13, 2, 4);
  add_map_branch(map, 14, 7, 8);
  return map;
}

void expect_consistent(const Route& route) {
  ASSERT_FALSE(route.points.empty());
  double length = 0.0;
  double narrowest = route.points.front().clearance_m;
  for (std::size_t i = 1; i < route.points.size(); ++i) {
    length += (route.points[i].position_m - route.points[i - 1].position_m).norm();
    narrowest = std::min(narrowest, route.points[i].clearance_m);
  }
  EXPECT_NEAR(route.length_m, length, 1e-9);
  EXPECT_EQ(route.min_clearance_m, narrowest);
}

TEST(Plan, TakesTheShorterRoute) {
  const PlanResult result = plan(ring(), {4, 1}, {3, 9});
  ASSERT_TRUE(result.found()) << result.reason;
  expect_consistent(result.route);
  EXPECT_TRUE(result.reason.empty());
  EXPECT_NEAR(result.route.length_m, 4 + 10 + 3, 1e-9);
  EXPECT_THAT(result.route.node_ids, ElementsAre(1, 3));
  EXPECT_THAT(result.route.branch_ids, ElementsAre(10, 12, 11));
  EXPECT_EQ(result.route.min_clearance_m, 0.4);
  EXPECT_TRUE(result.route.points.front().position_m.isApprox(Eigen::Vector2d(4, 0)));
  EXPECT_TRUE(result.route.points.back().position_m.isApprox(Eigen::Vector2d(3, 10)));
  EXPECT_NEAR(result.start->distance_m, 1.0, 1e-12);
  EXPECT_EQ(result.goal->branch_id, 11U);
}

TEST(Plan, GoesRoundWhereTheRobotDoesNotFit) {
  const PlanResult result = plan(ring(), {4, 0}, {3, 10}, {3.0, 0.5});
  ASSERT_TRUE(result.found()) << result.reason;
  expect_consistent(result.route);
  EXPECT_NEAR(result.route.length_m, 16 + 10 + 17, 1e-9);
  EXPECT_THAT(result.route.node_ids, ElementsAre(2, 4));
  EXPECT_EQ(result.route.min_clearance_m, 1.0);
}

TEST(Plan, GoesAlongAVirtualBranchWhateverItsClearance) {
  // The robot drove from 2 to 7 without seeing anything.
  GlobalMap map = ring();
  ASSERT_EQ(plan(map, {19, 0}, {35, 0}).status, PlanStatus::kNotConnected);
  add_map_branch(map, 15, 2, 7, {{25, 0}}, 0.0);
  EXPECT_EQ(plan(map, {19, 0}, {35, 0}).status, PlanStatus::kTooNarrow);
  map.branches.back().is_virtual = true;
  const PlanResult result = plan(map, {19, 0}, {35, 0});
  ASSERT_TRUE(result.found()) << result.reason;
  expect_consistent(result.route);
  EXPECT_THAT(result.route.branch_ids, ElementsAre(10, 15, 14));
  EXPECT_NEAR(result.route.length_m, 16.0, 1e-9);
  EXPECT_EQ(result.route.min_clearance_m, 0.0);
  // The robot may also be on it when it gets its goal.
  EXPECT_EQ(plan(map, {24, 1}, {35, 0}).start->branch_id, 15U);
  EXPECT_TRUE(plan_between_nodes(map, 1, 8).found());
}

TEST(Plan, StaysOnOneBranchWhenBothEndsLieOnIt) {
  for (const auto& [from, to] : {std::pair(3.0, 17.0), std::pair(17.0, 3.0)}) {
    const PlanResult result = plan(ring(), {from, 0.5}, {to, -0.5});
    ASSERT_TRUE(result.found());
    expect_consistent(result.route);
    EXPECT_NEAR(result.route.length_m, 14.0, 1e-12);
    EXPECT_TRUE(result.route.node_ids.empty());
    EXPECT_THAT(result.route.branch_ids, ElementsAre(10));
    EXPECT_TRUE(result.route.points.front().position_m.isApprox(Eigen::Vector2d(from, 0)));
    EXPECT_TRUE(result.route.points.back().position_m.isApprox(Eigen::Vector2d(to, 0)));
  }
}

TEST(Plan, OfStartOnTheGoalIsOnePlaceOfNoLength) {
  const PlanResult result = plan(ring(), {5, 0}, {5, 0});
  ASSERT_TRUE(result.found());
  expect_consistent(result.route);
  EXPECT_EQ(result.route.length_m, 0.0);
  for (const RoutePoint& p : result.route.points) EXPECT_EQ(p.position_m, Eigen::Vector2d(5, 0));
}

TEST(Plan, OutAndBackIsTheSameRoute) {
  const GlobalMap map = ring();
  const PlanResult out = plan(map, {4, 1}, {3, 9});
  const PlanResult back = plan(map, {3, 9}, {4, 1});
  ASSERT_EQ(out.route.points.size(), back.route.points.size());
  for (std::size_t i = 0; i < out.route.points.size(); ++i) {
    EXPECT_EQ(out.route.points[i].position_m,
              back.route.points[back.route.points.size() - 1 - i].position_m);
  }
}

TEST(Plan, FollowsALoopBranchOnItsShorterSide) {
  GlobalMap map;
  add_map_node(map, 1, 0, 0);
  add_map_branch(map, 5, 1, 1, {{4, 0}, {4, 4}, {0, 4}});
  const PlanResult result = plan(map, {1, 0}, {0, 1});
  ASSERT_TRUE(result.found());
  EXPECT_NEAR(result.route.length_m, 2.0, 1e-12);
  EXPECT_THAT(result.route.node_ids, ElementsAre(1));
}

TEST(Plan, TakesTheShorterOfTwoBranchesBetweenTheSameNodes) {
  GlobalMap map;
  add_map_node(map, 1, 0, 0);
  add_map_node(map, 2, 4, 0);
  add_map_branch(map, 5, 1, 2, {{2, 3}});
  add_map_branch(map, 6, 1, 2);
  EXPECT_THAT(plan_between_nodes(map, 2, 1).route.branch_ids, ElementsAre(6));
}

TEST(Plan, SaysWhyThereIsNoRoute) {
  const GlobalMap map = ring();
  PlanResult result = plan({}, {0, 0}, {1, 1});
  EXPECT_EQ(result.status, PlanStatus::kEmptyMap);
  EXPECT_FALSE(result.start.has_value());

  result = plan(map, {5, 5}, {1, 0});
  EXPECT_EQ(result.status, PlanStatus::kStartTooFar);
  EXPECT_THAT(result.reason, HasSubstr("start is 5.00 m"));
  EXPECT_THAT(result.reason, HasSubstr("expected at most 3.00 m"));
  EXPECT_NEAR(result.start->distance_m, 5.0, 1e-12);

  result = plan(map, {1, 0}, {1, -4});
  EXPECT_EQ(result.status, PlanStatus::kGoalTooFar);
  EXPECT_THAT(result.reason, HasSubstr("goal is 4.00 m from the nearest passable branch at (1.00"));

  result = plan(map, {1, 0}, {35, 0});
  EXPECT_EQ(result.status, PlanStatus::kNotConnected);
  EXPECT_TRUE(result.route.points.empty());

  result = plan(map, {1, 0}, {1, 10}, {3.0, 2.0});
  EXPECT_EQ(result.status, PlanStatus::kTooNarrow);
  EXPECT_THAT(result.reason, HasSubstr("2.00 m"));

  result = plan(map, {std::numeric_limits<double>::quiet_NaN(), 0}, {1, 0});
  EXPECT_EQ(result.status, PlanStatus::kInvalidPoint);
}

TEST(Plan, DistinguishesANarrowRouteFromNone) {
  GlobalMap map;
  for (std::uint32_t i = 0; i < 4; ++i) add_map_node(map, i, 10.0 * i, 0);
  add_map_branch(map, 1, 0, 1);
  add_map_branch(map, 2, 1, 2, {}, 0.2);
  add_map_branch(map, 3, 2, 3);
  const PlanResult result = plan(map, {1, 0}, {29, 0});
  EXPECT_EQ(result.status, PlanStatus::kTooNarrow);
  EXPECT_TRUE(plan(map, {1, 0}, {29, 0}, {3.0, 0.2}).found());
}

TEST(PlanBetweenNodes, NamesTheNodesOfTheRoute) {
  const PlanResult result = plan_between_nodes(ring(), 1, 4);
  ASSERT_TRUE(result.found());
  expect_consistent(result.route);
  EXPECT_NEAR(result.route.length_m, 30.0, 1e-9);
  EXPECT_EQ(result.route.node_ids.front(), 1U);
  EXPECT_EQ(result.route.node_ids.back(), 4U);
  EXPECT_EQ(result.route.node_ids.size(), 3U);
}

TEST(PlanBetweenNodes, SaysWhyThereIsNoRoute) {
  EXPECT_EQ(plan_between_nodes(ring(), 1, 99).status, PlanStatus::kUnknownNode);
  EXPECT_EQ(plan_between_nodes(ring(), 1, 7).status, PlanStatus::kNotConnected);
  EXPECT_EQ(plan_between_nodes({}, 1, 7).status, PlanStatus::kEmptyMap);
  EXPECT_EQ(plan_between_nodes(ring(), 1, 4, {3.0, 5.0}).status, PlanStatus::kTooNarrow);
  const PlanResult same = plan_between_nodes(ring(), 2, 2);
  ASSERT_TRUE(same.found());
  EXPECT_EQ(same.route.points.size(), 1U);
}

TEST(PlanningConfig, NamesTheFieldOutOfRange) {
  try {
    (void)plan(ring(), {0, 0}, {1, 0}, {-1.0, 0.3});
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("key 'planning.max_snap_m' = '-1'"));
  }
  EXPECT_THROW(check(PlanningConfig{1.0, std::nan("")}), std::invalid_argument);
}

// All shortest lengths by Floyd and Warshall's algorithm; infinite where there is no path.
std::vector<std::vector<double>> all_lengths(const GlobalMap& map, double min_clearance_m) {
  const std::size_t n = map.nodes.size();
  std::vector d(n, std::vector<double>(n, std::numeric_limits<double>::infinity()));
  for (std::size_t i = 0; i < n; ++i) d[i][i] = 0.0;
  for (const topomap::MapBranch& b : map.branches) {
    double length = 0.0;
    for (std::size_t i = 1; i < b.points.size(); ++i) {
      length += (b.points[i].position_m - b.points[i - 1].position_m).norm();
    }
    if (b.points.front().clearance_m < min_clearance_m) continue;
    d[b.node_a][b.node_b] = std::min(d[b.node_a][b.node_b], length);
    d[b.node_b][b.node_a] = d[b.node_a][b.node_b];
  }
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
    }
  }
  return d;
}

TEST(PlanBetweenNodes, AgreesWithFloydAndWarshallOnRandomMaps) {
  std::mt19937 random(11);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::size_t found = 0;
  std::size_t missing = 0;
  for (int round = 0; round < 60; ++round) {
    GlobalMap map;
    const std::uint32_t n = 2 + below(9);
    for (std::uint32_t i = 0; i < n; ++i) add_map_node(map, i, 20 * unit(), 20 * unit());
    const std::uint32_t branches = 1 + below(2 * n);
    for (std::uint32_t i = 0; i < branches; ++i) {
      add_map_branch(map, i, below(n), below(n), {{20 * unit(), 20 * unit()}}, unit());
    }
    const auto lengths = all_lengths(map, 0.3);
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = 0; b < n; ++b) {
        const PlanResult result = plan_between_nodes(map, a, b);
        if (result.status == PlanStatus::kUnknownNode) continue;
        ASSERT_EQ(result.found(), std::isfinite(lengths[a][b])) << round << ' ' << a << ' ' << b;
        result.found() ? ++found : ++missing;
        if (!result.found() || a == b) continue;
        EXPECT_NEAR(result.route.length_m, lengths[a][b], 1e-9);
        EXPECT_GE(result.route.min_clearance_m, 0.3);
        expect_consistent(result.route);
      }
    }
  }
  EXPECT_GT(found, 500U);
  EXPECT_GT(missing, 100U);
}

}  // namespace
}  // namespace topogeo::planning
