// Pulls a path over cells straight, as far as sight allows.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "cell_line.hpp"

namespace topogeo::planning {

/// The first cell, those where the direction changes, and the last.
std::vector<Cell> corners_of(std::span<const Cell> cells);

/// As `straighten` of motion_primitives.hpp, for a predicate of the passable cells.
template <typename Passable>
std::vector<Eigen::Vector2d> straighten_where(const GridFrame& frame, const Passable& passable,
                                              std::span<const Cell> cells,
                                              const Eigen::Vector2d& from_m,
                                              const Eigen::Vector2d& to_m) {
  std::vector<Eigen::Vector2d> points_m{from_m};
  for (const Cell& cell : corners_of(cells)) points_m.push_back(frame.center_m(cell));
  points_m.push_back(to_m);
  const auto sees = [&](const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
    return visit_line(frame.in_cells(a_m), frame.in_cells(b_m), passable);
  };
  std::vector<Eigen::Vector2d> path_m{from_m};
  std::size_t at = 0;
  while (at + 1 < points_m.size()) {
    std::size_t next = at + 1;
    while (next + 1 < points_m.size() && sees(points_m[at], points_m[next + 1])) ++next;
    if (points_m[next] != path_m.back()) path_m.push_back(points_m[next]);
    at = next;
  }
  return path_m;
}

}  // namespace topogeo::planning
