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
  /// Points of the free space: cells that cannot be reached from any of them without crossing a
  /// line (inside of furniture, behind the outer walls) are unknown. Empty: everything is free.
  std::vector<Eigen::Vector2d> inside_m{};
};

/// The grid of a drawing with `margin_m` around it; its origin is a multiple of the resolution.
/// Every cell that a line or disc touches is occupied. Throws std::invalid_argument for an empty
/// drawing, a coordinate that is not finite and a grid out of range (see check(GridFrame)).
OccupancyGrid grid_of(const Drawing& drawing, double resolution_m = 0.1, double margin_m = 1.0);

/// The parts of walls outside of openings and doors, in order.
std::vector<Drawing::Line> open_walls(std::span<const DrawnLine> lines);

/// The grid of a floor that was drawn from scratch: walls are occupied except at openings and
/// doors, and cells that no path from `inside_m` reaches are unknown. Throws std::invalid_argument
/// like grid_of, and if that point is in a wall or outside.
OccupancyGrid grid_of_floor(std::span<const DrawnLine> lines, const Eigen::Vector2d& inside_m,
                            double resolution_m = 0.1, double margin_m = 1.0);

/// The grid seen by the scans of the located stops, in the order of the stops: a cell is occupied
/// if its log-odds are above zero, free if they are below, unknown at zero and if no beam went
/// there. Only beams with an echo count. `maps[i]` is the map of `stops[i]`. Throws
/// std::invalid_argument if there are more stops than maps, no scan point at all, or the grid is
/// out of range.
OccupancyGrid grid_from_scans(std::span<const topomap::LocalMap> maps,
                              std::span<const topomap::StopPose> stops,
                              const ScanGridConfig& config = {});

/// A drawing and the scans of it, on the grid of the drawing, which grows by multiples of
/// snap_cells if scans reach further; resolution and margin are those of the drawing. A cell is
/// occupied if either source has it so, otherwise free if either has it so. Without any scan point
/// it is the drawing. Throws std::invalid_argument like grid_from_scans.
OccupancyGrid grid_of_both(const OccupancyGrid& drawn, std::span<const topomap::LocalMap> maps,
                           std::span<const topomap::StopPose> stops,
                           const ScanGridConfig& config = {});

}  // namespace topogeo::planning
