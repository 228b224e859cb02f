#include "topogeo/planning/zone_middles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"

#include "cell_neighbours.hpp"

namespace topogeo::planning {
namespace {

struct Middle {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();  // of cells
  double cells = 0.0;
  double deepest = 0.0;  // distance to the outline, cells
  double away2 = std::numeric_limits<double>::infinity();
  std::optional<Cell> cell;
};

/// Distances of cells in zones to the outlines of these.
FreeSpace depths(const GridFrame& frame, std::span<const ZoneId> zone_of_cell) {
  OccupancyGrid inside(frame, CellState::kOccupied);
  for (std::size_t i = 0; i < zone_of_cell.size(); ++i) {
    bool same = zone_of_cell[i] != kNoZone;
    visit_neighbours(frame, i,
                     [&](std::size_t j) { same = same && zone_of_cell[j] == zone_of_cell[i]; });
    if (same) inside.set(frame.cell_at(i), CellState::kFree);
  }
  return FreeSpace(std::move(inside), {.forbidden_cells = 0.0});
}

}  // namespace

std::vector<std::optional<Cell>> middles_of_zones(const GridFrame& frame,
                                                  std::span<const ZoneId> zone_of_cell,
                                                  std::size_t zones) {
  constexpr double kInside_m = 1.0;
  constexpr double kOfDeepest = 0.7;
  const FreeSpace space = depths(frame, zone_of_cell);
  const auto depth = [&](std::size_t i) {
    return std::sqrt(static_cast<double>(space.squared_cells(i)));
  };
  std::vector<Middle> found(zones);
  const auto for_each_cell = [&](const auto& use) {
    for (std::size_t i = 0; i < zone_of_cell.size(); ++i) {
      if (zone_of_cell[i] < zones) use(i, found[zone_of_cell[i]]);
    }
  };
  for_each_cell([&](std::size_t i, Middle& middle) {
    const Cell cell = frame.cell_at(i);
    middle.sum += Eigen::Vector2d(cell.column, cell.row);
    middle.cells += 1.0;
    middle.deepest = std::max(middle.deepest, depth(i));
  });
  for_each_cell([&](std::size_t i, Middle& middle) {
    const double wanted = std::min(kInside_m / frame.resolution_m, kOfDeepest * middle.deepest);
    if (depth(i) < wanted) return;
    const Cell cell = frame.cell_at(i);
    const double away2 =
        (Eigen::Vector2d(cell.column, cell.row) - middle.sum / middle.cells).squaredNorm();
    if (away2 >= middle.away2) return;
    middle.away2 = away2;
    middle.cell = cell;
  });
  std::vector<std::optional<Cell>> middles;
  middles.reserve(found.size());
  for (const Middle& middle : found) middles.push_back(middle.cell);
  return middles;
}

}  // namespace topogeo::planning
