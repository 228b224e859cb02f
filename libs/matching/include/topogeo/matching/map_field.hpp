// Nearness of every place in a finished map to a surface, in two grids: a coarse one to find the
// few places that a scan may come from, and a fine one to distinguish them.
//
// The kernels are integers up to 255, so that their sums are the same on every machine and many are
// added at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// A grid of kernel values with a margin of zeros.
class KernelGrid {
 public:
  KernelGrid() = default;
  /// Points in the map frame, metres. Cells become larger than `cell_m` if the grid would have more
  /// than 2^24 of them. The grid extends `margin_m` beyond the points.
  KernelGrid(std::span<const Eigen::Vector2d> points_m, double cell_m, double width_m,
             double margin_m);

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// May lie outside the grid.
  [[nodiscard]] int column(double x_m) const {
    return floor_to_int((x_m - origin_m_.x()) / cell_m_);
  }
  [[nodiscard]] int row(double y_m) const { return floor_to_int((y_m - origin_m_.y()) / cell_m_); }
  [[nodiscard]] Eigen::Vector2d centre_m(int column, int row) const {
    return origin_m_ + Eigen::Vector2d(column + 0.5, row + 0.5) * cell_m_;
  }
  /// 255 at a point, falling to 0 at the width and beyond; 0 outside the grid.
  [[nodiscard]] int at(double x_m, double y_m) const {
    const double column = (x_m - origin_m_.x()) / cell_m_;
    const double row = (y_m - origin_m_.y()) / cell_m_;
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return 0;
    return cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
  }
  [[nodiscard]] const std::uint8_t* row_data(int row) const {
    return cells_.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  }

 private:
  static int floor_to_int(double value);

  Eigen::Vector2d origin_m_ = Eigen::Vector2d::Zero();
  double cell_m_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> cells_;
};

/// Mean kernel value of points at a pose, in [0, 1].
double mean_kernel(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
                   const geometry::Pose2& T_map_robot);

/// Climbs from a pose to the largest mean kernel value nearby: steps of 0.12 m and 3 degrees,
/// halved three times.
struct Climbed {
  geometry::Pose2 T_map_robot;
  double value = 0.0;  ///< mean_kernel
};
Climbed climb(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
              const geometry::Pose2& T_start);

}  // namespace topogeo::localization
