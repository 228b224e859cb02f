// Allowed positions of the robot's centre: the grid without all cells too near to an obstacle (the
// forbidden cells of MACONDO, III.2; docs/algorithms.md, "Hybrid map and planner"), and the
// clearance of every cell.
//
// Distances are exact Euclidean ones between cell centres, by the separable transform of
// Felzenszwalb and Huttenlocher (2012) on squared integers, so they are the same on every machine.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/driving_rules.hpp"
#include "topogeo/planning/grid_config.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

class FreeSpace {
 public:
  /// The robot keeps the same distance from no-go zones among `zones` as from obstacles. Cells of
  /// drawn walls are occupied, cells of openings and doors free, whatever their state in `grid`.
  /// Throws std::invalid_argument like `check`.
  explicit FreeSpace(OccupancyGrid grid, const InflationConfig& config = {},
                     std::span<const DrawnZone> zones = {}, std::span<const DrawnLine> lines = {});

  /// The same floor, opened by evidence better than the grid: `freed` cells become free unless a
  /// drawn wall stands there, and the robot's centre may also be in `entered` cells, even if they
  /// are too near to an obstacle. All must lie inside.
  [[nodiscard]] FreeSpace opened(std::span<const Cell> freed, std::span<const Cell> entered) const;

  /// The grid for planning: with drawn walls, openings and doors.
  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }
  /// The given grid, as seen by sensors.
  [[nodiscard]] const OccupancyGrid& seen() const { return seen_ ? *seen_ : grid_; }
  [[nodiscard]] const GridFrame& frame() const { return grid_.frame(); }
  [[nodiscard]] const InflationConfig& inflation() const { return config_; }
  /// Further rules of the zones.
  [[nodiscard]] const DrivingRules& rules() const { return rules_; }

  /// Whether the robot's centre may be in the cell; false outside.
  [[nodiscard]] bool passable(const Cell& cell) const {
    return frame().contains(cell) && passable_[frame().index(cell)] != 0;
  }
  [[nodiscard]] bool passable(std::size_t index) const { return passable_[index] != 0; }

  /// Distance from the centre of a cell inside to that of the nearest obstacle (occupied, with
  /// inflate_unknown also unknown), metres; infinity if the grid has none.
  [[nodiscard]] double clearance_m(const Cell& cell) const;

  /// The same in cells, squared; kNoObstacle if the grid has none.
  [[nodiscard]] std::int32_t squared_cells(std::size_t index) const { return squared_[index]; }
  static constexpr std::int32_t kNoObstacle = std::numeric_limits<std::int32_t>::max();

 private:
  void draw_lines();
  void keep_out_of_no_go(double forbidden);
  void close_pockets();

  OccupancyGrid grid_;
  std::optional<OccupancyGrid> seen_;  // nothing: the same
  InflationConfig config_;
  std::vector<std::int32_t> squared_;
  std::vector<std::uint8_t> passable_;
  DrivingRules rules_;
};

}  // namespace topogeo::planning
