// Nearest of a set of points to a place, in constant time: the look-up of both the fitness and the
// refinement.
//
// Each cell holds the index of the point nearest to its centre, up to `reach_m`. Distances are then
// computed exactly for that point, so the only error is the choice of a second-nearest point near a
// cell border.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace topogeo::localization {

class NearestPointGrid {
 public:
  static constexpr std::int32_t kNone = -1;

  /// Finds nothing.
  NearestPointGrid() : nearest_(1, 0) {}

  /// Points in any one frame, metres. `cell_m` > 0, `reach_m` >= `cell_m`. Throws
  /// std::invalid_argument for more than 65,534 points, or if they lie so far apart that the grid
  /// would have more than 2^22 cells.
  void build(const std::vector<Eigen::Vector2d>& points_m, double cell_m, double reach_m);

  /// Index of the point nearest to the cell of (x, y); kNone if none lies within reach.
  [[nodiscard]] std::int32_t find(double x_m, double y_m) const {
    const double column = (x_m - origin_x_m_) * cells_per_m_;
    const double row = (y_m - origin_y_m_) * cells_per_m_;
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return kNone;
    const std::uint16_t found =
        nearest_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                 static_cast<std::size_t>(column)];
    return found == count_ ? kNone : found;
  }

  /// For each of four finite places the index of the point nearest to its cell; the number of
  /// points if none lies within reach. Single precision can put a place within some micrometres of
  /// a border into the neighbouring cell.
  [[nodiscard]] std::array<std::size_t, 4> find_four(const Eigen::Array4f& x_m,
                                                     const Eigen::Array4f& y_m) const {
    // Cells at the border have no point in reach, so places outside are moved there.
    const Eigen::Array4f column = ((x_m - float_origin_x_m_) * float_cells_per_m_)
                                      .max(0.0F)
                                      .min(static_cast<float>(columns_ - 1));
    const Eigen::Array4f row = ((y_m - float_origin_y_m_) * float_cells_per_m_)
                                   .max(0.0F)
                                   .min(static_cast<float>(rows_ - 1));
    std::array<std::size_t, 4> found;
    for (Eigen::Index k = 0; k < 4; ++k) {
      const int cell = static_cast<int>(row[k]) * columns_ + static_cast<int>(column[k]);
      found[static_cast<std::size_t>(k)] = nearest_[static_cast<std::size_t>(cell)];
    }
    return found;
  }

 private:
  double origin_x_m_ = 0.0;
  double origin_y_m_ = 0.0;
  double cells_per_m_ = 1.0;
  float float_origin_x_m_ = 0.0F;  // single-precision copies
  float float_origin_y_m_ = 0.0F;
  float float_cells_per_m_ = 1.0F;
  int columns_ = 1;
  int rows_ = 1;
  std::uint16_t count_ = 0;             // of the points
  std::vector<std::uint16_t> nearest_;  // count_: none
};

}  // namespace topogeo::localization
