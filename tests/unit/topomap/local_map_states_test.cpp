// States and the main graph on hand-made branches: one along x with given clearances.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/topomap/local_map_builder.hpp"

namespace topogeo::topomap {
namespace {

using voronoi::DiagramPoint;
using voronoi::LocalVoronoiDiagram;

void add_traced_branch(LocalVoronoiDiagram& diagram, const std::vector<DiagramPoint>& points,
                       std::array<std::uint16_t, 2> groups = {0, 1}) {
  const auto begin = static_cast<std::uint32_t>(diagram.points.size());
  diagram.points.insert(diagram.points.end(), points.begin(), points.end());
  const auto end = static_cast<std::uint32_t>(diagram.points.size());
  diagram.branches.push_back({.base_groups = groups, .points = {begin, end}});
}

LocalMap map_of_branches(const LocalVoronoiDiagram& diagram, const LocalMapConfig& config) {
  LocalMap map;
  build_local_map(diagram, scan::Scan{}, {}, config, map);
  return map;
}

/// States of a branch, in order.
std::vector<LocalNode> states_of(const std::vector<DiagramPoint>& points,
                                 const LocalMapConfig& config) {
  LocalVoronoiDiagram diagram;
  add_traced_branch(diagram, points);
  std::vector<LocalNode> states;
  for (const LocalNode& node : map_of_branches(diagram, config).nodes) {
    if (node.kind != NodeKind::kFictitious) states.push_back(node);
  }
  return states;
}

/// Between two jambs at x = 1.025: a branch through a gap twice `half_width_m` wide.
std::vector<DiagramPoint> through_a_gap(double half_width_m) {
  std::vector<DiagramPoint> points;
  for (int i = 0; i <= 40; ++i) {
    points.push_back({{0.05 * i, 0.0}, std::hypot(half_width_m, 0.05 * i - 1.025)});
  }
  return points;
}

// Eq. 5.1 with 5.3 and 5.4, worked by hand: down to x = 0.5, up to x = 1, level from there on. A
// single outlier at x = 0.2 does not turn the slope upwards, but by the printed rule the return
// from it counts.
TEST(LocalMapStates, EachConfirmedChangeOfSlopeIsAStateByTheRuleOfTheThesis) {
  LocalMapConfig config;
  config.state_rule = StateRule::kSlopes;
  config.state_confirm_m = 0.15;
  std::vector<DiagramPoint> points;
  for (int i = 0; i <= 40; ++i) {
    const double x_m = 0.05 * i;
    points.push_back({{x_m, 0.0}, x_m < 1.0 ? 0.5 + std::fabs(x_m - 0.5) : 1.0});
  }
  points[4].clearance_m += 0.08;  // one reading
  const std::vector<LocalNode> states = states_of(points, config);
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].kind, NodeKind::kHallCorridor);
  EXPECT_NEAR(states[0].position_m.x(), 0.25, 1e-9);
  EXPECT_EQ(states[1].kind, NodeKind::kDoor);
  EXPECT_NEAR(states[1].position_m.x(), 0.55, 1e-9);  // 5.2: the first point of the new slope
  EXPECT_EQ(states[2].kind, NodeKind::kHallCorridor);
  EXPECT_NEAR(states[2].position_m.x(), 1.05, 1e-9);
}

TEST(LocalMapStates, AGapThatIsTooNarrowForTheRobotIsNoDoor) {
  LocalMapConfig config;
  config.door_half_width_m = 0.6;
  config.door_min_half_width_m = 0.275;
  const auto kind_of = [&](double half_width_m) {
    const auto states = states_of(through_a_gap(half_width_m), config);
    EXPECT_EQ(states.size(), 1U);
    if (states.size() != 1) return NodeKind::kVirtual;
    EXPECT_NEAR(states[0].position_m.x(), 1.025, 0.002);
    return states[0].kind;
  };
  EXPECT_EQ(kind_of(0.25), NodeKind::kNarrowing);
  EXPECT_EQ(kind_of(0.3), NodeKind::kDoor);
  EXPECT_EQ(kind_of(0.55), NodeKind::kDoor);
  EXPECT_EQ(kind_of(0.65), NodeKind::kNarrowing);
  config.door_min_half_width_m = 0.2;
  EXPECT_EQ(kind_of(0.25), NodeKind::kDoor);
}

/// A corridor 2 m wide up to x = 3.013, where one or both walls end; hidden from x = `seen_m` on.
std::vector<DiagramPoint> into_a_hall(double growth, double seen_m) {
  std::vector<DiagramPoint> points;
  for (int i = 0; i <= 90; ++i) {
    const double x_m = 0.05 * i;
    const double beyond_m = std::max(0.0, x_m - 3.013);
    const double clearance_m = std::sqrt(1.0 + growth * beyond_m * beyond_m);
    points.push_back({{x_m, 0.0}, clearance_m, x_m < seen_m ? 0.0 : 0.5 * clearance_m});
  }
  return points;
}

TEST(LocalMapStates, TheMouthOfACorridorIsWhereItsWallsEnd) {
  for (const double growth : {1.0, 0.5}) {  // both walls end, or only one
    for (const bool reversed : {false, true}) {
      auto points = into_a_hall(growth, 10.0);
      if (reversed) std::ranges::reverse(points);
      const auto states = states_of(points, {});
      ASSERT_EQ(states.size(), 1U);
      EXPECT_EQ(states[0].kind, NodeKind::kHallCorridor);
      EXPECT_NEAR(states[0].position_m.x(), 3.013, 0.01);
      EXPECT_NEAR(states[0].clearance_m, 1.0, 0.001);
    }
  }
}

TEST(LocalMapStates, AHallIsNoneUntilTheRiseToItWasSeen) {
  LocalMapConfig config;
  config.hall_rise_m = 0.3;
  config.largest_hidden_share = 0.2;
  // Behind the mouth the clearance reaches 1.3 m at x = 3.84.
  EXPECT_EQ(states_of(into_a_hall(1.0, 4.0), config).size(), 1U);
  EXPECT_TRUE(states_of(into_a_hall(1.0, 3.6), config).empty());
  config.largest_hidden_share = 1.0;  // everything counts as seen, as in the Thesis
  EXPECT_EQ(states_of(into_a_hall(1.0, 3.6), config).size(), 1U);
}

/// A straight branch with a clearance of 1 m.
std::vector<DiagramPoint> level(double from_x_m, double to_x_m, double y_m) {
  std::vector<DiagramPoint> points;
  const int steps = static_cast<int>(std::lround((to_x_m - from_x_m) / 0.1));
  for (int i = 0; i <= steps; ++i) points.push_back({{from_x_m + 0.1 * i, y_m}, 1.0});
  return points;
}

TEST(MainGraph, AStubBesideTheRobotIsNotTheWayToGo) {
  LocalVoronoiDiagram diagram;
  add_traced_branch(diagram, level(0.0, 0.8, 0.2), {0, 1});
  add_traced_branch(diagram, level(0.0, 1.2, -1.0), {1, 2});
  add_traced_branch(diagram, level(0.0, 3.0, -2.0), {2, 3});
  LocalMapConfig config;
  config.min_main_graph_m = 1.0;
  const auto main_branches = [&] {
    std::vector<std::uint32_t> ids;
    for (const LocalBranch& branch : map_of_branches(diagram, config).branches) {
      if (branch.in_main_graph) ids.push_back(branch.id);
    }
    return ids;
  };
  using Ids = std::vector<std::uint32_t>;
  EXPECT_EQ(main_branches(), Ids{1});  // the nearest one of sufficient length
  config.min_main_graph_m = 0.5;
  EXPECT_EQ(main_branches(), Ids{0});
  config.min_main_graph_m = 0.0;
  EXPECT_EQ(main_branches(), Ids{0});
  config.min_main_graph_m = 2.0;
  EXPECT_EQ(main_branches(), Ids{2});
  config.min_main_graph_m = 5.0;  // none is long enough: the nearest of all
  EXPECT_EQ(main_branches(), Ids{0});
  // The length includes all branches of the graph.
  add_traced_branch(diagram, level(1.0, 1.5, 0.2), {0, 1});
  config.min_main_graph_m = 1.0;
  EXPECT_EQ(main_branches(), (Ids{0, 3}));
}

}  // namespace
}  // namespace topogeo::topomap
