#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap::test {

/// Expects the invariants of every local map: ids, ends of branches, finite coordinates, branches
/// with two base groups of their nodes and on the main graph with them.
inline void expect_well_formed(const LocalMap& map) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i) {
    const LocalNode& node = map.nodes[i];
    EXPECT_EQ(node.id, i);
    EXPECT_GE(node.base_groups.size(), 2U);
    EXPECT_TRUE(node.position_m.allFinite() && std::isfinite(node.clearance_m));
  }
  for (std::size_t i = 0; i < map.branches.size(); ++i) {
    const LocalBranch& branch = map.branches[i];
    EXPECT_EQ(branch.id, i);
    ASSERT_GE(branch.points.size(), 2U);
    ASSERT_LT(std::max(branch.node_a, branch.node_b), map.nodes.size());
    EXPECT_EQ(branch.points.front().position_m, map.nodes[branch.node_a].position_m);
    EXPECT_EQ(branch.points.back().position_m, map.nodes[branch.node_b].position_m);
    for (const std::uint32_t node : {branch.node_a, branch.node_b}) {
      EXPECT_EQ(branch.in_main_graph, map.nodes[node].in_main_graph);
      EXPECT_TRUE(std::ranges::includes(map.nodes[node].base_groups, branch.base_groups));
    }
    for (const BranchPoint& point : branch.points) {
      EXPECT_TRUE(point.position_m.allFinite() && std::isfinite(point.clearance_m));
    }
  }
}

}  // namespace topogeo::topomap::test
