#include "grid_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::navigation {

using planning::Cell;
using planning::CellState;
using planning::GridFrame;
using planning::OccupancyGrid;

namespace {

/// The cell around any point, even outside of the grid.
Cell around(const GridFrame& frame, const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d in_cells = frame.in_cells(point_m);
  return {static_cast<std::int32_t>(std::floor(in_cells.x())),
          static_cast<std::int32_t>(std::floor(in_cells.y()))};
}

/// Calls `visit` for every cell of the grid whose middle is at most `reach_m` from the point, until
/// it returns true; returns whether it did.
template <class Visit>
bool visit_disc(const GridFrame& frame, const Eigen::Vector2d& point_m, double reach_m,
                Visit visit) {
  const Cell middle = around(frame, point_m);
  const auto reach = static_cast<std::int32_t>(std::ceil(reach_m / frame.resolution_m));
  for (std::int32_t row = middle.row - reach; row <= middle.row + reach; ++row) {
    for (std::int32_t column = middle.column - reach; column <= middle.column + reach; ++column) {
      const Cell cell{column, row};
      if (!frame.contains(cell)) continue;
      if ((frame.center_m(cell) - point_m).norm() <= reach_m && visit(cell)) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<Cell> best_cell(const GridFrame& frame, const Eigen::Vector2d& point_m,
                              double reach_m, const std::function<bool(const Cell&)>& good,
                              const std::function<double(const Eigen::Vector2d&)>& cost) {
  std::optional<Cell> best;
  double best_cost = std::numeric_limits<double>::infinity();
  visit_disc(frame, point_m, reach_m, [&](const Cell& cell) {
    const double cell_cost = cost(frame.center_m(cell));
    if (cell_cost < best_cost && good(cell)) {
      best = cell;
      best_cost = cell_cost;
    }
    return false;
  });
  return best;
}

std::optional<Cell> nearest_cell(const GridFrame& frame, const Eigen::Vector2d& point_m,
                                 double reach_m, const std::function<bool(const Cell&)>& good) {
  return best_cell(frame, point_m, reach_m, good,
                   [&](const Eigen::Vector2d& at_m) { return (at_m - point_m).norm(); });
}

namespace {

/// The zones that a robot may be in: the zone of its cell, or, if that is not passable or a pocket
/// made by noise, all zones that it sees near by, because it may have come from any of them.
std::vector<planning::ZoneId> zones_around(const planning::HybridMap& map,
                                           const Eigen::Vector2d& from_m) {
  constexpr double kNear_m = 0.5;
  std::vector<planning::ZoneId> zones;
  const auto own = map.frame().cell_of(from_m);
  if (own && map.space().passable(*own)) {
    const double cell_m2 = map.frame().resolution_m * map.frame().resolution_m;
    const planning::ZoneId zone = map.zone_of(*own);
    if (static_cast<double>(map.zones().zones[zone].cells) * cell_m2 > planning::kPocket_m2) {
      return {zone};
    }
  }
  visit_disc(map.frame(), from_m, kNear_m, [&](const Cell& cell) {
    const planning::ZoneId zone = map.zone_of(cell);
    if (zone != planning::kNoZone && std::find(zones.begin(), zones.end(), zone) == zones.end() &&
        nothing_between(map.space().grid(), from_m, map.frame().center_m(cell))) {
      zones.push_back(zone);
    }
    return false;
  });
  return zones;
}

}  // namespace

std::vector<bool> reachable_zones(const planning::HybridMap& map, const Eigen::Vector2d& from_m) {
  std::vector<bool> zones(map.zones().zones.size(), false);
  std::vector<planning::GraphAccess> entries;
  for (const planning::ZoneId zone : zones_around(map, from_m)) {
    zones[zone] = true;
    for (const std::uint32_t node : map.nodes_of(zone)) entries.push_back({node, 0.0});
  }
  if (entries.empty()) return zones;
  const std::vector<bool> nodes = map.graph().reached(entries);
  for (const planning::BorderNode& node : map.nodes()) {
    if (!nodes[node.id]) continue;
    for (const planning::ZoneId zone : node.zones) zones[zone] = true;
  }
  return zones;
}

bool nothing_between(const OccupancyGrid& grid, const Eigen::Vector2d& a_m,
                     const Eigen::Vector2d& b_m) {
  constexpr double kStepsPerCell = 3.0;
  const Eigen::Vector2d a = grid.frame().in_cells(a_m);
  const Eigen::Vector2d b = grid.frame().in_cells(b_m);
  const double steps = std::ceil(kStepsPerCell * (b - a).norm());
  for (double step = 0.0; step <= steps; step += 1.0) {
    const Eigen::Vector2d at = steps > 0.0 ? a + (step / steps) * (b - a) : a;
    const Cell cell{static_cast<std::int32_t>(std::floor(at.x())),
                    static_cast<std::int32_t>(std::floor(at.y()))};
    if (grid.frame().contains(cell) && grid.at(cell) == CellState::kOccupied) return false;
  }
  return true;
}

bool any_unknown(const OccupancyGrid& grid, const Eigen::Vector2d& point_m, double reach_m) {
  return visit_disc(grid.frame(), point_m, reach_m,
                    [&](const Cell& cell) { return grid.at(cell) == CellState::kUnknown; });
}

Eigen::Vector2d toward_unknown(const OccupancyGrid& grid, const Eigen::Vector2d& point_m,
                               double reach_m) {
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  visit_disc(grid.frame(), point_m, reach_m, [&](const Cell& cell) {
    if (grid.at(cell) == CellState::kUnknown) sum_m += grid.frame().center_m(cell) - point_m;
    return false;
  });
  if (sum_m.norm() < 1e-6) return Eigen::Vector2d::UnitX();
  return sum_m;
}

}  // namespace topogeo::navigation
