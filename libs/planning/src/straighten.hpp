// Pulls a path over cells straight, as far as sight allows.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"

#include "cell_line.hpp"

namespace topogeo::planning {

/// The first cell, cells where the direction changes, and the last one.
std::vector<Cell> corners_of(std::span<const Cell> cells);

/// Like `straighten` of motion_primitives.hpp, for any predicate of passable cells.
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

/// The same, but lines neither leave an area of the rules nor violate a one-way zone: straightening
/// must not undo the gain of a detour.
template <typename Passable>
std::vector<Eigen::Vector2d> straighten_by_rules(const FreeSpace& space, const Passable& passable,
                                                 std::span<const Cell> cells,
                                                 const Eigen::Vector2d& from_m,
                                                 const Eigen::Vector2d& to_m) {
  const GridFrame& frame = space.frame();
  const DrivingRules& rules = space.rules();
  if (!rules.guides()) return straighten_where(frame, passable, cells, from_m, to_m);
  const auto area = [&](const Cell& cell) { return rules.area(frame.index(cell)); };
  std::vector<Eigen::Vector2d> path_m{from_m};
  for (std::size_t begin = 0, end = 0; begin < cells.size(); begin = end) {
    const std::uint32_t own = area(cells[begin]);
    while (end < cells.size() && area(cells[end]) == own) ++end;
    const Eigen::Vector2d piece_from_m = begin == 0 ? from_m : frame.center_m(cells[begin]);
    const Eigen::Vector2d piece_to_m = end == cells.size() ? to_m : frame.center_m(cells[end - 1]);
    const std::span<const Cell> piece = cells.subspan(begin, end - begin);
    const auto here = [&](const Cell& cell) {
      return frame.contains(cell) && passable(cell) && area(cell) == own;
    };
    std::vector<Eigen::Vector2d> points_m =
        straighten_where(frame, here, piece, piece_from_m, piece_to_m);
    for (std::size_t i = 1; i < points_m.size(); ++i) {
      const Eigen::Vector2d line = frame.in_cells(points_m[i]) - frame.in_cells(points_m[i - 1]);
      if (rules.allows(frame.index(cells[begin]), line)) continue;
      const auto nowhere = [](const Cell&) { return false; };
      points_m = straighten_where(frame, nowhere, piece, piece_from_m, piece_to_m);
      break;
    }
    for (const Eigen::Vector2d& point_m : points_m) {
      if (point_m != path_m.back()) path_m.push_back(point_m);
    }
  }
  return path_m;
}

}  // namespace topogeo::planning
