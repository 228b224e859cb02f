#include "route_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "topogeo/planning/motion_primitives.hpp"
#include "topogeo/support/format.hpp"

#include "drawn_obstructions.hpp"
#include "nearest_in_sight.hpp"

namespace topogeo::planning {

std::string shown(const Eigen::Vector2d& point_m) {
  return fmt::format("({:.2f}, {:.2f})", point_m.x(), point_m.y());
}

HybridRoute no_route(RouteStatus status, std::string reason) {
  HybridRoute route;
  route.status = status;
  route.reason = std::move(reason);
  return route;
}

std::optional<Cell> EndFinder::find(const std::string& what, const Eigen::Vector2d& point_m,
                                    double snap_m, RouteStatus outside, RouteStatus occupied,
                                    HybridRoute& failure) const {
  const auto cell = space_.frame().cell_of(point_m);
  if (!cell) {
    failure = no_route(outside, what + " is outside of the grid");
    return std::nullopt;
  }
  if (open(*cell)) return cell;
  const auto is_open = [this](const Cell& c) { return open(c); };
  const auto is_clear = [this](const Cell& c) { return clear(c); };
  if (const auto near = nearest_in_sight(space_.frame(), point_m, snap_m, is_open, is_clear)) {
    return near;
  }
  const CellState state = space_.grid().at(*cell);
  const auto drawn = drawn_obstruction(space_, point_m);
  if (drawn && state != CellState::kUnknown) {
    failure = no_route(occupied, what + " " + *drawn);
  } else if (state == CellState::kUnknown) {
    failure = no_route(outside, what + " is in unknown space");
  } else if (state == CellState::kOccupied) {
    failure = no_route(occupied, what + " is in an obstacle");
  } else if (cells_.filled(*cell)) {
    failure = no_route(occupied, what + " is in an obstacle that is not on the map");
  } else {
    const bool on_map = !space_.passable(*cell);
    failure = no_route(occupied,
                       fmt::format("{} is {:.2f} m from an obstacle{}: too near", what,
                                   on_map ? space_.clearance_m(*cell) : cells_.clearance_m(*cell),
                                   on_map ? "" : " that is not on the map"));
  }
  return std::nullopt;
}

std::optional<Cell> EndFinder::start(const Eigen::Vector2d& point_m, double snap_m,
                                     HybridRoute& failure) const {
  return find("the start " + shown(point_m), point_m, snap_m, RouteStatus::kStartOutside,
              RouteStatus::kStartOccupied, failure);
}

std::optional<Cell> EndFinder::start_apart(const HybridMap& map, const Eigen::Vector2d& point_m,
                                           double snap_m, const std::vector<ZoneId>& zones) const {
  const auto own = space_.frame().cell_of(point_m);
  if (!own) return std::nullopt;
  if (open(*own)) {
    const double cell_m2 = space_.frame().resolution_m * space_.frame().resolution_m;
    const auto cells = static_cast<double>(map.zones().zones[map.zone_of(*own)].cells);
    if (cells * cell_m2 > kPocket_m2) return std::nullopt;
  }
  const auto apart = [&](const Cell& c) {
    return open(c) && std::find(zones.begin(), zones.end(), map.zone_of(c)) == zones.end();
  };
  return nearest_in_sight(space_.frame(), point_m, snap_m, apart,
                          [this](const Cell& c) { return clear(c); });
}

std::optional<Cell> EndFinder::goal(const Eigen::Vector2d& point_m, double snap_m,
                                    HybridRoute& failure) const {
  return find("the goal " + shown(point_m), point_m, snap_m, RouteStatus::kGoalOutside,
              RouteStatus::kGoalOccupied, failure);
}

std::optional<Eigen::Vector2d> nearest_cell_m(const GridFrame& frame,
                                              const Eigen::Vector2d& point_m,
                                              const std::vector<bool>& reachable) {
  std::optional<Eigen::Vector2d> best;
  double best_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!reachable[i]) continue;
    const Eigen::Vector2d middle_m = frame.center_m(frame.cell_at(i));
    const double distance_m = (middle_m - point_m).norm();
    if (distance_m >= best_m) continue;
    best = middle_m;
    best_m = distance_m;
  }
  return best;
}

void measure(const ClosedCells& cells, const GridFrame& frame, HybridRoute& route) {
  route.cost_m = cost_cells(route.cells) * frame.resolution_m;
  route.min_clearance_m = std::numeric_limits<double>::infinity();
  for (const Cell& cell : route.cells) {
    route.min_clearance_m = std::min(route.min_clearance_m, cells.clearance_m(cell));
  }
  route.length_m = length_m(route.points_m);
  for (const Eigen::Vector2d& point_m : route.points_m) {
    route.clearances_m.push_back(cells.clearance_m(frame.cell_of(point_m).value()));
  }
}

}  // namespace topogeo::planning
