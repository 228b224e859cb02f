#include "topogeo/localization/nearest_point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::localization {

void NearestPointGrid::build(const std::vector<Eigen::Vector2d>& points_m, double cell_m,
                             double reach_m) {
  columns_ = rows_ = 0;
  if (points_m.empty()) return;
  Eigen::Vector2d low = points_m.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  cells_per_m_ = 1.0 / cell_m;
  origin_x_m_ = low.x() - reach_m - cell_m;
  origin_y_m_ = low.y() - reach_m - cell_m;
  columns_ = static_cast<int>((high.x() - origin_x_m_ + reach_m + cell_m) * cells_per_m_) + 1;
  rows_ = static_cast<int>((high.y() - origin_y_m_ + reach_m + cell_m) * cells_per_m_) + 1;
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  nearest_.assign(cells, kNone);
  squared_m2_.assign(cells, std::numeric_limits<float>::max());

  // Rounded up: a place just within reach must not fall into a cell that was left out.
  const int reach_cells = static_cast<int>(std::ceil(reach_m * cells_per_m_));
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double x = (points_m[i].x() - origin_x_m_) * cells_per_m_;
    const double y = (points_m[i].y() - origin_y_m_) * cells_per_m_;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    for (int r = std::max(0, row - reach_cells); r <= std::min(rows_ - 1, row + reach_cells); ++r) {
      const double dy = r + 0.5 - y;
      const auto line = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_);
      const int last = std::min(columns_ - 1, column + reach_cells);
      for (int c = std::max(0, column - reach_cells); c <= last; ++c) {
        const double dx = c + 0.5 - x;
        const auto squared = static_cast<float>(dx * dx + dy * dy);
        float& best = squared_m2_[line + static_cast<std::size_t>(c)];
        if (squared < best) {
          best = squared;
          nearest_[line + static_cast<std::size_t>(c)] = static_cast<std::int32_t>(i);
        }
      }
    }
  }
}

}  // namespace topogeo::localization
