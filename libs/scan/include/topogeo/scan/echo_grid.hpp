// Echoes at any angle on the beams of one grid.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace topogeo::scan {

struct Echo {
  double angle_rad = 0.0;
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();  ///< at that angle, laser frame
};

/// Directions of beams.
struct EchoGrid {
  double angle_min_rad = 0.0;
  double angle_step_rad = 0.0;  ///< > 0
  std::size_t beams = 0;
};

/// One range per beam of `grid`; Scan::kNoReturn without an echo. A beam between two echoes of one
/// surface, each at most one and a half steps away, gets the range at which it meets the line
/// between them; otherwise the nearest echo within half a step counts. The angles of the echoes are
/// finite.
std::vector<float> on_grid(std::vector<Echo> echoes, const EchoGrid& grid);

}  // namespace topogeo::scan
