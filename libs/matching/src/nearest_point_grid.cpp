#include "topogeo/matching/nearest_point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace topogeo::localization {
namespace {

// Limits of the representation.
constexpr std::size_t kMostPoints = std::numeric_limits<std::uint16_t>::max() - 1U;
constexpr double kMostCells = 4'194'304.0;  // 200 m x 200 m; single precision counts to 2^24

// Cells of a row processed at once: twice the lanes of a vector, or once those of a wide one.
constexpr int kLanes = 8;

// The cells within reach of a point: a square around it.
struct Window {
  int first_row;
  int first_column;
  double y;  // of the point, in cells
};

// The windows of all points, in their order.
struct Windows {
  int rows;   // of each window
  int width;  // the same number of columns, rounded up to a multiple of kLanes
  std::vector<Window> windows;
  // Squared distance from the point to its columns, `width` per window; the padding is infinite.
  std::vector<float> across_squared;
};

// Some rows of the grid.
struct Band {
  int first_row;
  int end_row;
  std::size_t columns;
  // Elements are as wide as a distance, so that vectors hold equally many of both. Both have extra
  // room for the padding columns of the windows in the last row.
  std::vector<std::int32_t> nearest;
  std::vector<float> squared;  // distance of the nearest so far
};

// Enters point `i` into those of a row's cells, from its window's first on, to which it is nearer
// than the `nearest` so far. Uses masks, because the compiler vectorises those but not two
// selections.
inline void take_nearer(const float* __restrict across_squared, int width, float dy_squared,
                        std::int32_t i, float* __restrict squared,
                        std::int32_t* __restrict nearest) {
  for (int lanes = 0; lanes < width; lanes += kLanes) {
    for (int c = lanes; c < lanes + kLanes; ++c) {
      const float distance = across_squared[c] + dy_squared;
      const float before = squared[c];
      const std::int32_t nearer = -static_cast<std::int32_t>(distance < before);
      nearest[c] = (i & nearer) | (nearest[c] & ~nearer);
      squared[c] = distance < before ? distance : before;
    }
  }
}

// Twice the vector width where the processor has it, with the same arithmetic. Not with sanitizers,
// because the choice runs before they are initialised.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TOPOGEO_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define TOPOGEO_WIDE_VECTORS
#endif

// Writes the nearest point of each cell of the band, row by row, to `found`; `none` without one.
TOPOGEO_WIDE_VECTORS void fill(const Windows& windows, std::uint16_t none, Band& band,
                               std::uint16_t* found) {
  const int width = windows.width;
  const std::size_t cells = band.columns * static_cast<std::size_t>(band.end_row - band.first_row);
  std::fill_n(band.nearest.begin(), cells, none);
  std::fill_n(band.squared.begin(), cells, std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < windows.windows.size(); ++i) {
    const Window& window = windows.windows[i];
    const float* const across_squared =
        &windows.across_squared[i * static_cast<std::size_t>(width)];
    const int end = std::min(window.first_row + windows.rows, band.end_row);
    for (int r = std::max(window.first_row, band.first_row); r < end; ++r) {
      const auto dy = static_cast<float>(r + 0.5 - window.y);
      const std::size_t first = static_cast<std::size_t>(r - band.first_row) * band.columns +
                                static_cast<std::size_t>(window.first_column);
      take_nearer(across_squared, width, dy * dy, static_cast<std::int32_t>(i),
                  &band.squared[first], &band.nearest[first]);
    }
  }
  for (std::size_t k = 0; k < cells; ++k) found[k] = static_cast<std::uint16_t>(band.nearest[k]);
}

Windows windows_around(const std::vector<Eigen::Vector2d>& points_m,
                       const Eigen::Vector2d& origin_m, double cells_per_m, int reach_cells) {
  const int rows = 2 * reach_cells + 1;
  const int width = (rows + kLanes - 1) / kLanes * kLanes;
  Windows around{rows, width, {}, {}};
  around.windows.reserve(points_m.size());
  around.across_squared.assign(points_m.size() * static_cast<std::size_t>(width),
                               std::numeric_limits<float>::infinity());
  float* across_squared = around.across_squared.data();
  for (const Eigen::Vector2d& p : points_m) {
    const double x = (p.x() - origin_m.x()) * cells_per_m;
    const double y = (p.y() - origin_m.y()) * cells_per_m;
    const int first_column = static_cast<int>(x) - reach_cells;
    around.windows.push_back({static_cast<int>(y) - reach_cells, first_column, y});
    const auto first_dx = static_cast<float>(first_column + 0.5 - x);
    for (int c = 0; c < rows; ++c) {
      const float dx = first_dx + static_cast<float>(c);
      across_squared[c] = dx * dx;
    }
    across_squared += width;
  }
  return around;
}

// The nearest point of each cell, row by row; `none` without one. Works band by band, so that the
// data stay in the cache.
void find_nearest(const Windows& windows, int rows, int columns, std::uint16_t none,
                  std::vector<std::uint16_t>& nearest) {
  constexpr int kBandRows = 32;
  const auto row_cells = static_cast<std::size_t>(columns);
  nearest.resize(static_cast<std::size_t>(rows) * row_cells);
  const std::size_t most_cells =
      static_cast<std::size_t>(std::min(kBandRows, rows)) * row_cells + kLanes;
  Band band{0, 0, row_cells, std::vector<std::int32_t>(most_cells), std::vector<float>(most_cells)};
  for (; band.end_row < rows; band.first_row = band.end_row) {
    band.end_row = std::min(band.first_row + kBandRows, rows);
    fill(windows, none, band, &nearest[static_cast<std::size_t>(band.first_row) * row_cells]);
  }
}

}  // namespace

void NearestPointGrid::build(const std::vector<Eigen::Vector2d>& points_m, double cell_m,
                             double reach_m) {
  std::vector<std::uint16_t> recycled = std::move(nearest_);
  *this = NearestPointGrid();
  if (points_m.empty()) return;
  if (points_m.size() > kMostPoints) {
    throw std::invalid_argument("nearest-point grid: " + std::to_string(points_m.size()) +
                                " points, expected at most " + std::to_string(kMostPoints));
  }
  Eigen::Vector2d low = points_m.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  NearestPointGrid made;
  made.cells_per_m_ = 1.0 / cell_m;
  // Rounded up: a place just within reach must not fall into a cell that is left out.
  const int reach_cells = static_cast<int>(std::ceil(reach_m * made.cells_per_m_));
  const double margin_m = (reach_cells + 2) * cell_m;  // the outermost cells stay empty
  const Eigen::Vector2d origin_m(low.x() - margin_m, low.y() - margin_m);
  made.origin_x_m_ = origin_m.x();
  made.origin_y_m_ = origin_m.y();
  made.float_cells_per_m_ = static_cast<float>(made.cells_per_m_);
  made.float_origin_x_m_ = static_cast<float>(origin_m.x());
  made.float_origin_y_m_ = static_cast<float>(origin_m.y());
  const double columns = std::floor((high.x() + margin_m - origin_m.x()) * made.cells_per_m_) + 1.0;
  const double rows = std::floor((high.y() + margin_m - origin_m.y()) * made.cells_per_m_) + 1.0;
  if (!(columns * rows <= kMostCells)) {
    throw std::invalid_argument("nearest-point grid: the points lie too far apart for a grid of " +
                                std::to_string(cell_m) + " m, or are not finite");
  }
  made.columns_ = static_cast<int>(columns);
  made.rows_ = static_cast<int>(rows);
  made.count_ = static_cast<std::uint16_t>(points_m.size());
  made.nearest_ = std::move(recycled);
  find_nearest(windows_around(points_m, origin_m, made.cells_per_m_, reach_cells), made.rows_,
               made.columns_, made.count_, made.nearest_);
  *this = std::move(made);
}

}  // namespace topogeo::localization
