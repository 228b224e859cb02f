// One scan and all results of perception for it, gathered for pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::render {

/// Neighbouring visible cells along y whose nearest sites belong to one group, laser frame.
struct CellRun {
  Eigen::Vector2d min_m = Eigen::Vector2d::Zero();  ///< corner with the least x and y
  Eigen::Vector2d max_m = Eigen::Vector2d::Zero();  ///< opposite corner
  std::uint16_t group = 0;
};

struct ScanView {
  scan::Scan scan;
  voronoi::VoronoiConfig voronoi;
  topomap::LocalMapConfig local_map;
  voronoi::LocalVoronoiDiagram diagram;  ///< laser frame
  std::vector<double> free_range_m;      ///< per beam
  std::vector<CellRun> cells;            ///< in rows of the grid
  topomap::LocalMap map;                 ///< robot frame; without id, track and odometry
};

/// Computes the diagram with `diagram_maker`, which keeps its tables for the next scan of the same
/// geometry, and the local map from it. Throws std::invalid_argument like LocalVoronoi::compute.
ScanView make_scan_view(const scan::Scan& scan, voronoi::LocalVoronoi& diagram_maker,
                        const topomap::LocalMapConfig& local_map,
                        const geometry::Pose2& T_robot_laser);

}  // namespace topogeo::render
