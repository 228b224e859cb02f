// Finding the cells that a route begins and ends at, and the reason when there is none.
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

/// A route that there is not.
HybridRoute no_route(RouteStatus status, std::string reason);

/// Finds the cells that a route begins and ends at.
class EndFinder {
 public:
  EndFinder(const FreeSpace& space, const ClosedCells& cells) : space_(space), cells_(cells) {}

  /// The open cell of a point, or the nearest one within snap_m that no obstacle hides. Without
  /// any, `failure` gets status and reason of a route that begins there.
  [[nodiscard]] std::optional<Cell> start(const Eigen::Vector2d& point_m, double snap_m,
                                          HybridRoute& failure) const;

  /// Where else a route may begin whose start is not open, or in a zone of at most a square metre,
  /// as noise parts from the floor around it: as start(), of the cells in none of the zones given.
  [[nodiscard]] std::optional<Cell> start_apart(const HybridMap& map,
                                                const Eigen::Vector2d& point_m, double snap_m,
                                                const std::vector<ZoneId>& zones) const;

  /// The same as start() for a route that ends there.
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

/// Middle of the cell nearest to a point of all those that are reachable (by index); of equally
/// near ones the first.
std::optional<Eigen::Vector2d> nearest_cell_m(const GridFrame& frame,
                                              const Eigen::Vector2d& point_m,
                                              const std::vector<bool>& reachable);

/// Cost, clearances and length of a route from its cells and points.
void measure(const ClosedCells& cells, const GridFrame& frame, HybridRoute& route);

}  // namespace topogeo::planning
