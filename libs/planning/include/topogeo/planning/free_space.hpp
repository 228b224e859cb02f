// Where the robot's middle may be: the grid with everything forbidden that is too near to an
// obstacle (the forbidden cells of MACONDO, III.2; docs/algorithms.md, "Hybrid map and planner"),
// and the clearance of every cell.
//
// Distances are exact Euclidean ones between the middles of cells, by the separable transform of
// Felzenszwalb and Huttenlocher (2012) on squared integers, so they are the same everywhere.
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
  /// The robot keeps out of no-go zones among `zones` as far as from obstacles. Cells of drawn
  /// walls are occupied, those of openings and doors free, whatever `grid` has there. Throws
  /// std::invalid_argument as `check`.
  explicit FreeSpace(OccupancyGrid grid, const InflationConfig& config = {},
                     std::span<const DrawnZone> zones = {}, std::span<const DrawnLine> lines = {});

  /// The same floor where something better than the grid shows that it is open: `freed` cells are
  /// free, unless a drawn wall stands there, and the robot's middle may be in `entered` ones, too,
  /// however near to an obstacle they are. All must lie inside.
  [[nodiscard]] FreeSpace opened(std::span<const Cell> freed, std::span<const Cell> entered) const;

  /// To plan on: with drawn walls, openings and doors.
  [[nodiscard]] const OccupancyGrid& grid() const { return grid_; }
  /// As it was given: what sensors see.
  [[nodiscard]] const OccupancyGrid& seen() const { return seen_ ? *seen_ : grid_; }
  [[nodiscard]] const GridFrame& frame() const { return grid_.frame(); }
  [[nodiscard]] const InflationConfig& inflation() const { return config_; }
  /// What the zones demand besides.
  [[nodiscard]] const DrivingRules& rules() const { return rules_; }

  /// Whether the robot's middle may be in the cell; false outside.
  [[nodiscard]] bool passable(const Cell& cell) const {
    return frame().contains(cell) && passable_[frame().index(cell)] != 0;
  }
  [[nodiscard]] bool passable(std::size_t index) const { return passable_[index] != 0; }

  /// Distance from the middle of a cell inside to that of the nearest obstacle (occupied, with
  /// inflate_unknown also unknown), metres; infinity when the grid has none.
  [[nodiscard]] double clearance_m(const Cell& cell) const;

  /// The same in cells, squared; kNoObstacle when the grid has none.
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
