// Conditions for every route.
#pragma once

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::planning {

/// Cells are passable neighbours and cut no corner; straight lines stay in passable cells, except
/// the first line of a robot that starts at a forbidden place.
inline void expect_drivable(const FreeSpace& space, const HybridRoute& route) {
  for (const Cell& cell : route.cells) ASSERT_TRUE(space.passable(cell));
  for (std::size_t i = 1; i < route.cells.size(); ++i) {
    const Cell& a = route.cells[i - 1];
    const Cell& b = route.cells[i];
    ASSERT_EQ(std::max(std::abs(a.column - b.column), std::abs(a.row - b.row)), 1);
    ASSERT_TRUE(space.passable(Cell{a.column, b.row}));
    ASSERT_TRUE(space.passable(Cell{b.column, a.row}));
  }
  const Cell start = space.frame().cell_of(route.points_m.front()).value();
  for (std::size_t i = space.passable(start) ? 1 : 2; i < route.points_m.size(); ++i) {
    ASSERT_TRUE(in_sight(space, route.points_m[i - 1], route.points_m[i]));
  }
  EXPECT_TRUE(!space.passable(start) || route.length_m <= route.cost_m + 1e-9);
}

}  // namespace topogeo::planning
