// Scans of a corridor along x with its left wall at y = 1 m and its right one at y = -1.5 m.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "topogeo/render/scan_view.hpp"

namespace topogeo::render {

inline scan::Scan blind_scan(std::size_t beams) {
  scan::Scan scan;
  scan.sequence = 7;
  scan.stamp_ns = 12'345'000'000;
  scan.angle_min_rad = -0.5 * std::numbers::pi;
  scan.angle_step_rad = beams > 1 ? std::numbers::pi / static_cast<double>(beams - 1) : 0.01;
  scan.ranges_m.assign(beams, scan::Scan::kNoReturn);
  return scan;
}

/// 361 beams over 180 degrees, the farthest at 30 m; `with_left` and `with_right` select the walls.
inline scan::Scan corridor_scan(bool with_left, bool with_right) {
  scan::Scan scan = blind_scan(361);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double sin = std::sin(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    const double wall_m = sin > 0.0 ? 1.0 : 1.5;
    const double range_m = wall_m / std::max(std::fabs(sin), wall_m / 30.0);
    if (sin > 0.0 ? with_left : with_right) scan.ranges_m[i] = static_cast<float>(range_m);
  }
  return scan;
}

inline ScanView view_of(const scan::Scan& scan, const geometry::Pose2& T_robot_laser = {},
                        const voronoi::VoronoiConfig& config = {}) {
  voronoi::LocalVoronoi diagram_maker(config);
  topomap::LocalMapConfig local_map;
  local_map.points_range_m = std::min(config.range_limit_m, 80.0);  // the largest permitted value
  return make_scan_view(scan, diagram_maker, local_map, T_robot_laser);
}

}  // namespace topogeo::render
