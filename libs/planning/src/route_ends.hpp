// Finds the first and last cell of a route, or the reason why there is none.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/hybrid_planner.hpp"

#include "closed_cells.hpp"

namespace topogeo::planning {

/// "(1.00, 2.50)"
std::string shown(const Eigen::Vector2d& point_m);

/// A route that failed.
HybridRoute no_route(RouteStatus status, std::string reason);

/// Finds the first and last cell of a route.
class EndFinder {
 public:
  EndFinder(const FreeSpace& space, const ClosedCells& cells) : space_(space), cells_(cells) {}

  /// The open cell of a point, or the nearest visible one within snap_m. Without any, `failure`
  /// gets status and reason of a route that begins there.
  [[nodiscard]] std::optional<Cell> start(const Eigen::Vector2d& point_m, double snap_m,
                                          HybridRoute& failure) const;

  /// Another start cell for a point whose cell is not open, or in a pocket of at most a square
  /// metre that noise cuts off: like start(), but outside of the given zones.
  [[nodiscard]] std::optional<Cell> start_apart(const HybridMap& map,
                                                const Eigen::Vector2d& point_m, double snap_m,
                                                const std::vector<ZoneId>& zones) const;

  /// Like start(), for a route that ends there.
  [[nodiscard]] std::optional<Cell> goal(const Eigen::Vector2d& point_m, double snap_m,
                                         HybridRoute& failure) const;

 private:
  [[nodiscard]] std::optional<Cell> find(const std::string& what, const Eigen::Vector2d& point_m,
                                         double snap_m, RouteStatus outside, RouteStatus occupied,
                                         HybridRoute& failure) const;

  [[nodiscard]] bool open(const Cell& cell) const {
    return space_.passable(cell) && !cells_.forbids(cell);
  }
  [[nodiscard]] bool clear(const Cell& cell) const {
    return space_.grid().at(cell) != CellState::kOccupied && !cells_.filled(cell);
  }

  const FreeSpace& space_;
  const ClosedCells& cells_;
};

/// Centre of the reachable cell (by index) nearest to a point; the first one breaks ties.
std::optional<Eigen::Vector2d> nearest_cell_m(const GridFrame& frame,
                                              const Eigen::Vector2d& point_m,
                                              const std::vector<bool>& reachable);

/// Cost, clearances and length of a route from its cells and points.
void measure(const ClosedCells& cells, const GridFrame& frame, HybridRoute& route);

}  // namespace topogeo::planning
