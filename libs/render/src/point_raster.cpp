#include "point_raster.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace topogeo::render {

std::vector<RasterRun> raster_runs(const std::vector<ScanOutline>& outlines, const Layout& layout,
                                   double cell_m) {
  std::vector<std::pair<std::int64_t, std::int64_t>> cells;  // (row, column)
  for (const ScanOutline& outline : outlines) {
    for (const Eigen::Vector2d& point : outline) {
      const Eigen::Vector2d cell = (layout.turned_m(point) - layout.min_m) / cell_m;
      cells.emplace_back(static_cast<std::int64_t>(std::floor(cell.y())),
                         static_cast<std::int64_t>(std::floor(cell.x())));
    }
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());

  const auto left_edge_m = [&](std::int64_t row, std::int64_t column) {
    return Eigen::Vector2d(layout.min_m.x() + static_cast<double>(column) * cell_m,
                           layout.min_m.y() + (static_cast<double>(row) + 0.5) * cell_m);
  };
  std::vector<RasterRun> runs;
  for (std::size_t first = 0; first < cells.size();) {
    std::size_t last = first;
    while (last + 1 < cells.size() && cells[last + 1].first == cells[first].first &&
           cells[last + 1].second == cells[last].second + 1) {
      ++last;
    }
    const std::int64_t row = cells[first].first;
    runs.push_back(
        {left_edge_m(row, cells[first].second), left_edge_m(row, cells[last].second + 1)});
    first = last + 1;
  }
  return runs;
}

}  // namespace topogeo::render
