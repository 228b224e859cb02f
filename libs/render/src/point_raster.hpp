// Thins out laser points: each cell of a raster is drawn once, neighbours in a row as one stroke.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "layout.hpp"

namespace topogeo::render {

/// A run of cells: its line from the left edge of the first cell to the right edge of the last, at
/// half the height of the row, rotated frame.
struct RasterRun {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

/// Runs of occupied cells from bottom to top, from left to right. `cell_m` > 0.
std::vector<RasterRun> raster_runs(const std::vector<ScanOutline>& outlines, const Layout& layout,
                                   double cell_m);

}  // namespace topogeo::render
