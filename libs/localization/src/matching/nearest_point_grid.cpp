#include "topogeo/localization/matching/nearest_point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace topogeo::localization {
namespace {

// Limits of the representation.
constexpr std::size_t kMostPoints = std::numeric_limits<std::uint16_t>::max() - 1U;
constexpr double kMostCells = 4'194'304.0;  // 200 m x 200 m; single precision counts to 2^24

}  // namespace

void NearestPointGrid::build(const std::vector<Eigen::Vector2d>& points_m, double cell_m,
                             double reach_m) {
  *this = NearestPointGrid();
  if (points_m.empty()) return;
  if (points_m.size() > kMostPoints) {
    throw std::invalid_argument("nearest-point grid: " + std::to_string(points_m.size()) +
                                " points, allowed are " + std::to_string(kMostPoints));
  }
  Eigen::Vector2d low = points_m.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  cells_per_m_ = 1.0 / cell_m;
  // Rounded up: a place just within reach must not fall into a cell that was left out.
  const int reach_cells = static_cast<int>(std::ceil(reach_m * cells_per_m_));
  const double margin_m = (reach_cells + 2) * cell_m;  // the outermost cells stay empty
  origin_x_m_ = low.x() - margin_m;
  origin_y_m_ = low.y() - margin_m;
  float_cells_per_m_ = static_cast<float>(cells_per_m_);
  float_origin_x_m_ = static_cast<float>(origin_x_m_);
  float_origin_y_m_ = static_cast<float>(origin_y_m_);
  const double columns = std::floor((high.x() + margin_m - origin_x_m_) * cells_per_m_) + 1.0;
  const double rows = std::floor((high.y() + margin_m - origin_y_m_) * cells_per_m_) + 1.0;
  if (!(columns * rows <= kMostCells)) {
    throw std::invalid_argument("nearest-point grid: the points lie too far apart for a grid of " +
                                std::to_string(cell_m) + " m, or are not finite");
  }
  columns_ = static_cast<int>(columns);
  rows_ = static_cast<int>(rows);
  count_ = static_cast<std::uint16_t>(points_m.size());
  const auto cells = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  nearest_.assign(cells, count_);
  std::vector<float> squared(cells, std::numeric_limits<float>::max());  // of the nearest so far

  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double x = (points_m[i].x() - origin_x_m_) * cells_per_m_;
    const double y = (points_m[i].y() - origin_y_m_) * cells_per_m_;
    const int column = static_cast<int>(x);
    const int row = static_cast<int>(y);
    for (int r = row - reach_cells; r <= row + reach_cells; ++r) {
      const auto dy = static_cast<float>(r + 0.5 - y);
      const std::size_t first = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(column - reach_cells);
      float* best = &squared[first];
      std::uint16_t* nearest = &nearest_[first];
      const auto dx = static_cast<float>(column - reach_cells + 0.5 - x);
      for (int c = 0; c <= 2 * reach_cells; ++c) {
        const float across = dx + static_cast<float>(c);
        const float distance = across * across + dy * dy;
        nearest[c] = distance < best[c] ? static_cast<std::uint16_t>(i) : nearest[c];
        best[c] = distance < best[c] ? distance : best[c];
      }
    }
  }
}

}  // namespace topogeo::localization
