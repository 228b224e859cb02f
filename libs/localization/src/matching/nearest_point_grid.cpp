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

// Of `count` cells of one row: point `i`, in those to which it is nearer than the `nearest` so far.
// With masks, as the compiler makes vectors of that and not of two choices.
void take_nearer(const float* __restrict across_squared, int count, float dy_squared,
                 std::int32_t i, float* __restrict squared, std::int32_t* __restrict nearest) {
  for (int c = 0; c < count; ++c) {
    const float distance = across_squared[c] + dy_squared;
    const float before = squared[c];
    const std::int32_t nearer = -static_cast<std::int32_t>(distance < before);
    nearest[c] = (i & nearer) | (nearest[c] & ~nearer);
    squared[c] = distance < before ? distance : before;
  }
}

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
  // As wide as a distance, so that vectors hold as many of both.
  std::vector<std::int32_t> nearest(cells, count_);
  std::vector<float> squared(cells, std::numeric_limits<float>::max());  // of the nearest so far
  const int width = 2 * reach_cells + 1;
  std::vector<float> across_squared(static_cast<std::size_t>(width));

  for (std::size_t i = 0; i < points_m.size(); ++i) {
    const double x = (points_m[i].x() - origin_x_m_) * cells_per_m_;
    const double y = (points_m[i].y() - origin_y_m_) * cells_per_m_;
    const int first_column = static_cast<int>(x) - reach_cells;
    const int first_row = static_cast<int>(y) - reach_cells;
    for (int c = 0; c < width; ++c) {
      const float dx = static_cast<float>(first_column + 0.5 - x) + static_cast<float>(c);
      across_squared[static_cast<std::size_t>(c)] = dx * dx;
    }
    for (int r = first_row; r < first_row + width; ++r) {
      const auto dy = static_cast<float>(r + 0.5 - y);
      const std::size_t first = static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
                                static_cast<std::size_t>(first_column);
      take_nearer(across_squared.data(), width, dy * dy, static_cast<std::int32_t>(i),
                  &squared[first], &nearest[first]);
    }
  }
  nearest_.assign(nearest.begin(), nearest.end());
}

}  // namespace topogeo::localization
