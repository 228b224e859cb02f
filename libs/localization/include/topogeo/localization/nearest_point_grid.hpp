// Which of a set of points is nearest to a place, in constant time: the look-up under both the
// fitness and the refinement.
//
// Each cell holds the index of the point nearest to its centre, up to `reach_m`. Distances are then
// taken to that point exactly, so the only error is the choice of a second-nearest point near a
// cell border.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace topogeo::localization {

class NearestPointGrid {
 public:
  static constexpr std::int32_t kNone = -1;

  /// Points in any one frame, metres. `cell_m` > 0, `reach_m` >= `cell_m`.
  void build(const std::vector<Eigen::Vector2d>& points_m, double cell_m, double reach_m);

  /// Index of the point nearest to the cell of (x, y); kNone if none lies within reach.
  [[nodiscard]] std::int32_t find(double x_m, double y_m) const {
    const double column = (x_m - origin_x_m_) * cells_per_m_;
    const double row = (y_m - origin_y_m_) * cells_per_m_;
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return kNone;
    return nearest_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }

 private:
  double origin_x_m_ = 0.0;
  double origin_y_m_ = 0.0;
  double cells_per_m_ = 1.0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::int32_t> nearest_;
  std::vector<float> squared_m2_;  // of the nearest point so far, while building
};

}  // namespace topogeo::localization
