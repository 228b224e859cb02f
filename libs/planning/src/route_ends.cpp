#include "route_ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "topogeo/planning/motion_primitives.hpp"

#include "cell_line.hpp"

namespace topogeo::planning {
namespace {

bool hidden(const FreeSpace& space, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  const GridFrame& frame = space.frame();
  return !visit_line(frame.in_cells(a_m), frame.in_cells(b_m), [&](const Cell& cell) {
    return frame.contains(cell) && space.grid().at(cell) != CellState::kOccupied;
  });
}

std::optional<Cell> nearest_passable(const FreeSpace& space, const Cell& cell,
                                     const Eigen::Vector2d& point_m, double within_m) {
  const GridFrame& frame = space.frame();
  const auto reach = static_cast<std::int32_t>(within_m / frame.resolution_m) + 1;
  const CellBox box = grown({cell, cell}, reach, frame);
  std::optional<Cell> best;
  double best_m = within_m;
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column) {
      const Cell candidate{column, row};
      const Eigen::Vector2d middle_m = frame.center_m(candidate);
      const double distance_m = (middle_m - point_m).norm();
      if (!space.passable(candidate) || distance_m > best_m || (best && distance_m == best_m)) {
        continue;
      }
      if (hidden(space, point_m, middle_m)) continue;
      best = candidate;
      best_m = distance_m;
    }
  }
  return best;
}

}  // namespace

std::string shown(const Eigen::Vector2d& point_m) {
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "(%.2f, %.2f)", point_m.x(), point_m.y());
  return text.data();
}

HybridRoute no_route(RouteStatus status, std::string reason) {
  HybridRoute route;
  route.status = status;
  route.reason = std::move(reason);
  return route;
}

std::optional<Cell> find_end(const FreeSpace& space, const Eigen::Vector2d& point_m, double snap_m,
                             bool is_start, HybridRoute& failure) {
  const std::string what = std::string(is_start ? "the start " : "the goal ") + shown(point_m);
  const RouteStatus outside = is_start ? RouteStatus::kStartOutside : RouteStatus::kGoalOutside;
  const auto cell = space.frame().cell_of(point_m);
  if (!cell) {
    failure = no_route(outside, what + " is outside of the grid");
    return std::nullopt;
  }
  if (space.passable(*cell)) return cell;
  if (const auto near = nearest_passable(space, *cell, point_m, snap_m)) return near;
  const RouteStatus occupied = is_start ? RouteStatus::kStartOccupied : RouteStatus::kGoalOccupied;
  switch (space.grid().at(*cell)) {
    case CellState::kUnknown:
      failure = no_route(outside, what + " is where nothing is known");
      break;
    case CellState::kOccupied:
      failure = no_route(occupied, what + " is in an obstacle");
      break;
    case CellState::kFree: {
      std::array<char, 48> text{};
      std::snprintf(text.data(), text.size(), " is %.2f m from an obstacle: too near",
                    space.clearance_m(*cell));
      failure = no_route(occupied, what + text.data());
      break;
    }
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> nearest_cell_m(const GridFrame& frame,
                                              const Eigen::Vector2d& point_m,
                                              const std::function<bool(std::size_t)>& reachable) {
  std::optional<Eigen::Vector2d> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!reachable(i)) continue;
    const Eigen::Vector2d middle_m = frame.center_m(frame.cell_at(i));
    const double distance_m = (middle_m - point_m).norm();
    if (distance_m >= best_m) continue;
    best = middle_m;
    best_m = distance_m;
  }
  return best;
}

void fill_in(const FreeSpace& space, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
             HybridRoute& route) {
  route.status = RouteStatus::kFound;
  route.cost_m = cost_cells(route.cells) * space.frame().resolution_m;
  route.min_clearance_m = std::numeric_limits<double>::infinity();
  for (const Cell& cell : route.cells) {
    route.min_clearance_m = std::min(route.min_clearance_m, space.clearance_m(cell));
  }
  route.points_m = straighten(space, route.cells, from_m, to_m);
  route.length_m = length_m(route.points_m);
  for (const Eigen::Vector2d& point_m : route.points_m) {
    route.clearances_m.push_back(space.clearance_m(space.frame().cell_of(point_m).value()));
  }
}

}  // namespace topogeo::planning
