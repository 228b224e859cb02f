#include "topogeo/render/scan_view.hpp"

namespace topogeo::render {
namespace {

using voronoi::NearestSiteGrid;

std::vector<CellRun> cell_runs(const NearestSiteGrid& grid) {
  std::vector<CellRun> runs;
  const Eigen::Vector2d half_m = Eigen::Vector2d::Constant(0.5 * grid.resolution_m());
  for (int row = 0; row < grid.rows(); ++row) {
    for (int first = 0, end = 0; first < grid.cols(); first = end) {
      const std::uint16_t group = grid.group(row, first);
      for (end = first + 1; end < grid.cols() && grid.group(row, end) == group;) ++end;
      if (group == NearestSiteGrid::kNone) continue;
      runs.push_back({grid.centre(row, first) - half_m, grid.centre(row, end - 1) + half_m, group});
    }
  }
  return runs;
}

}  // namespace

ScanView make_scan_view(const scan::Scan& scan, voronoi::LocalVoronoi& diagram_maker,
                        const topomap::LocalMapConfig& local_map,
                        const geometry::Pose2& T_robot_laser) {
  ScanView view;
  view.scan = scan;
  view.voronoi = diagram_maker.config();
  view.local_map = local_map;
  diagram_maker.compute(scan, view.diagram);
  view.free_range_m.assign(diagram_maker.free_range_m().begin(),
                           diagram_maker.free_range_m().end());
  view.cells = cell_runs(diagram_maker.grid());
  view.map.sequence = scan.sequence;
  view.map.stamp_ns = scan.stamp_ns;
  topomap::build_local_map(view.diagram, scan, T_robot_laser, local_map, view.map);
  return view;
}

}  // namespace topogeo::render
