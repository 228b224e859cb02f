#include "topogeo/planning/local_detour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "topogeo/planning/grid_search.hpp"

#include "cell_order.hpp"
#include "nearest_in_sight.hpp"
#include "straighten.hpp"

namespace topogeo::planning {
namespace {

double distance(const Cell& a, const Cell& b) {
  return std::hypot(a.column - b.column, a.row - b.row);
}

std::size_t nearest_on_route(std::span<const Cell> route, const Cell& cell) {
  const auto nearer = [&](const Cell& a, const Cell& b) {
    return distance(a, cell) < distance(b, cell);
  };
  return static_cast<std::size_t>(std::min_element(route.begin(), route.end(), nearer) -
                                  route.begin());
}

std::vector<Cell> cells_of(const GridFrame& frame, std::span<const Eigen::Vector2d> points_m) {
  std::vector<Cell> cells;
  for (const Eigen::Vector2d& point_m : points_m) {
    if (const auto cell = frame.cell_of(point_m)) cells.push_back(*cell);
  }
  sort_cells(cells);
  return cells;
}

std::optional<Cell> start_of(const FreeSpace& space, const SearchWindow& window,
                             const std::vector<Cell>& obstacles, const Eigen::Vector2d& robot_m,
                             double snap_m) {
  const auto open = [&](const Cell& cell) { return window.open(cell); };
  const Cell robot = space.frame().cell_of(robot_m).value();
  if (open(robot)) return robot;
  const auto clear = [&](const Cell& cell) {
    return space.grid().at(cell) != CellState::kOccupied && !has_cell(obstacles, cell);
  };
  return nearest_in_sight(space.frame(), robot_m, snap_m, open, clear);
}

// Whether an open cell is connected to at most a square metre.
bool shut_in(const SearchWindow& window, const Cell& from, double resolution_m) {
  const auto most = static_cast<std::size_t>(kPocket_m2 / (resolution_m * resolution_m));
  std::vector<Cell> found{from};
  for (std::size_t i = 0; i < found.size() && found.size() <= most; ++i) {
    const Cell cell = found[i];
    for (const Cell& next : {Cell{cell.column + 1, cell.row}, Cell{cell.column - 1, cell.row},
                             Cell{cell.column, cell.row + 1}, Cell{cell.column, cell.row - 1}}) {
      const bool known = std::find(found.begin(), found.end(), next) != found.end();
      if (!known && window.open(next)) found.push_back(next);
    }
  }
  return found.size() <= most;
}

// Replacement for a start without a path: the open cell nearest to the robot, in its sight, with a
// path to `to`. Only for a robot whose cell is not open, or that is shut in.
std::optional<Cell> start_with_path(const FreeSpace& space, const SearchWindow& window,
                                    const std::vector<Cell>& obstacles,
                                    const Eigen::Vector2d& robot_m, double snap_m, const Cell& to) {
  const GridFrame& frame = space.frame();
  const Cell robot = frame.cell_of(robot_m).value();
  if (window.open(robot) && !shut_in(window, robot, frame.resolution_m)) return std::nullopt;
  const auto reach = static_cast<std::int32_t>(snap_m / frame.resolution_m) + 1;
  const CellBox box = grown({robot, robot}, reach, frame);
  std::vector<Cell> near;
  for (std::int32_t row = box.low.row; row <= box.high.row; ++row) {
    for (std::int32_t column = box.low.column; column <= box.high.column; ++column) {
      if (window.open({column, row})) near.push_back({column, row});
    }
  }
  const auto paths = shortest_paths(window, to, near);
  std::vector<Cell> joined;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (paths[i]) joined.push_back(near[i]);
  }
  sort_cells(joined);
  return nearest_in_sight(
      frame, robot_m, snap_m, [&](const Cell& cell) { return has_cell(joined, cell); },
      [&](const Cell& cell) {
        return space.grid().at(cell) != CellState::kOccupied && !has_cell(obstacles, cell);
      });
}

Detour failure(DetourStatus status, const char* reason) {
  Detour detour;
  detour.status = status;
  detour.reason = reason;
  return detour;
}

// The candidate with the shortest path to the end of the route; candidates are its last cells.
std::optional<std::size_t> cheapest(const std::vector<std::optional<CellPath>>& paths,
                                    std::span<const Cell> candidates) {
  std::optional<std::size_t> best;
  double best_cells = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (!paths[k]) continue;
    const double total = paths[k]->cost_cells + cost_cells(candidates.subspan(k));
    if (total >= best_cells) continue;
    best = k;
    best_cells = total;
  }
  return best;
}

// The contiguous cells of the route in the window, starting at `from`: [from, end).
std::size_t end_in_window(const SearchWindow& window, std::span<const Cell> route,
                          std::size_t from) {
  std::size_t end = from;
  while (end < route.size() && window.box().contains(route[end])) ++end;
  return end;
}

}  // namespace

std::string_view describe(DetourStatus status) {
  constexpr std::array<std::string_view, 4> kWords = {"clear", "found", "blocked", "lost"};
  const auto index = static_cast<std::size_t>(status);
  return index < kWords.size() ? kWords.at(index) : "unknown status";
}

Detour plan_detour(const FreeSpace& space, std::span<const Cell> route,
                   const Eigen::Vector2d& robot_m, const Eigen::Vector2d& goal_m,
                   std::span<const Eigen::Vector2d> obstacles_m, const DetourConfig& config) {
  check(config);
  const GridFrame& frame = space.frame();
  const auto finite = [](const Eigen::Vector2d& point_m) { return point_m.allFinite(); };
  if (route.empty() || !finite(robot_m) || !finite(goal_m) ||
      !std::all_of(obstacles_m.begin(), obstacles_m.end(), finite)) {
    throw std::invalid_argument("detour: the route is empty or a point is not finite");
  }
  const auto robot = frame.cell_of(robot_m);
  if (!robot) return failure(DetourStatus::kLost, "the robot is outside of the grid");
  const auto half = static_cast<std::int32_t>(config.half_side_m / frame.resolution_m);
  SearchWindow window(space, grown({*robot, *robot}, half, frame), SearchWindow::Rules::kObeyed);
  const std::vector<Cell> obstacles = cells_of(frame, obstacles_m);
  for (const Cell& cell : obstacles) {
    window.close_disc(cell, space.inflation().forbidden_cells);
  }
  const auto start = start_of(space, window, obstacles, robot_m, config.start_snap_m);
  if (!start) return failure(DetourStatus::kLost, "no passable cell is near the robot");
  const std::size_t from = nearest_on_route(route, *robot);
  const std::size_t end = end_in_window(window, route, from);
  if (end == from) return failure(DetourStatus::kLost, "the route does not pass near the robot");

  // Candidates are all cells behind the last blocked one; earlier ones are useless.
  std::size_t behind = end;
  while (behind > from && window.open(route[behind - 1])) --behind;
  if (behind == end) {
    return failure(DetourStatus::kBlocked, "the route is blocked up to the edge of the window");
  }
  const std::span<const Cell> candidates = route.subspan(behind, end - behind);
  auto paths = shortest_paths(window, *start, candidates);
  std::optional<std::size_t> best = cheapest(paths, candidates);
  if (!best) {
    const auto other =
        start_with_path(space, window, obstacles, robot_m, config.start_snap_m, candidates.front());
    if (other) {
      paths = shortest_paths(window, *other, candidates);
      best = cheapest(paths, candidates);
    }
  }
  if (!best) return failure(DetourStatus::kBlocked, "no path leads around within the window");
  Detour detour;
  detour.status = behind == from ? DetourStatus::kClear : DetourStatus::kFound;
  detour.rejoins = behind + *best;
  detour.cells = paths[*best]->cells;
  const auto rest = route.subspan(detour.rejoins + 1);
  detour.cells.insert(detour.cells.end(), rest.begin(), rest.end());
  const auto passable = [&](const Cell& cell) {
    return window.box().contains(cell) ? window.open(cell) : space.passable(cell);
  };
  detour.points_m = straighten_by_rules(space, passable, detour.cells, robot_m, goal_m);
  return detour;
}

}  // namespace topogeo::planning
