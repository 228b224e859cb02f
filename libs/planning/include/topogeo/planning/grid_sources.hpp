// Occupancy grids from drawings and from the scans of a mapped floor (MACONDO, III.2;
// docs/algorithms.md, "Hybrid map and planner").
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/grid_config.hpp"
#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::planning {

/// Walls as lines and columns as discs, map frame.
struct Drawing {
  struct Line {
    Eigen::Vector2d a_m;
    Eigen::Vector2d b_m;
  };
  struct Disc {
    Eigen::Vector2d center_m;
    double radius_m;
  };
  std::vector<Line> lines{};
  std::vector<Disc> discs{};
  /// Points of the free space: what cannot be reached from any of them without crossing a line
  /// (inside of furniture, behind the outer walls) is unknown. Empty: everything is free.
  std::vector<Eigen::Vector2d> inside_m{};
};

/// The grid of a drawing with `margin_m` around it; its origin is a multiple of the resolution.
/// Every cell that a line or disc touches is occupied. Throws std::invalid_argument for an empty
/// drawing, a coordinate that is not finite and a grid out of range (see check(GridFrame)).
OccupancyGrid grid_of(const Drawing& drawing, double resolution_m = 0.1, double margin_m = 1.0);

/// The pieces of walls that openings and doors leave, in order.
std::vector<Drawing::Line> open_walls(std::span<const DrawnLine> lines);

/// The grid of a floor that was drawn from nothing: walls are occupied but where openings and doors
/// are, what no path leads to from `inside_m` is unknown. Throws std::invalid_argument like
/// grid_of, and where that point is in a wall or outside.
OccupancyGrid grid_of_floor(std::span<const DrawnLine> lines, const Eigen::Vector2d& inside_m,
                            double resolution_m = 0.1, double margin_m = 1.0);

/// What the scans of the located stops saw, in the order of the stops: a cell is occupied when its
/// log-odds are above zero, free when they are below, unknown at zero and where no beam went. Only
/// beams with an echo count. `maps[i]` is the map of `stops[i]`. Throws std::invalid_argument when
/// there are more stops than maps, no scan point at all, or the grid is out of range.
OccupancyGrid grid_from_scans(std::span<const topomap::LocalMap> maps,
                              std::span<const topomap::StopPose> stops,
                              const ScanGridConfig& config = {});

/// A drawing and what scans saw of it, on the grid of the drawing, which grows by multiples of
/// snap_cells where scans reach further; resolution and margin are those of the drawing. A cell is
/// occupied where either has it so, otherwise free where either has it so. With no scan point at
/// all it is the drawing. Throws std::invalid_argument as grid_from_scans.
OccupancyGrid grid_of_both(const OccupancyGrid& drawn, std::span<const topomap::LocalMap> maps,
                           std::span<const topomap::StopPose> stops,
                           const ScanGridConfig& config = {});

}  // namespace topogeo::planning
