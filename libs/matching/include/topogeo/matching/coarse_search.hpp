// Coarse but exhaustive search for the pose of a set of points on a small map: branch and bound
// over position and heading (Hess, Kohler, Rapp, Andor, "Real-time loop closure in 2D LIDAR SLAM",
// ICRA 2016, algorithm 3); docs/algorithms.md, "Places".
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

/// Nearness of each cell to a point of the map, with the maxima over squares of 1, 2, 4, ... cells
/// that bound the score a search can still reach.
class CoarseMap {
 public:
  static constexpr double kCell_m = 0.25;
  static constexpr int kLevels = 5;  ///< squares of 1 to 16 cells

  CoarseMap() = default;
  /// Throws std::invalid_argument if the points are spread over more than 250 m.
  explicit CoarseMap(std::span<const Eigen::Vector2d> points_m);

  /// 255 at a point, 0 from 0.6 m on; the largest value in the square of 2^level cells that begins
  /// at this cell.
  [[nodiscard]] std::uint8_t at(int level, int column, int row) const {
    const Level& l = levels_[static_cast<std::size_t>(level)];
    const int c = column + l.margin;
    const int r = row + l.margin;
    if (c < 0 || r < 0 || c >= l.columns || r >= l.rows) return 0;
    return l.cells[static_cast<std::size_t>(r) * static_cast<std::size_t>(l.columns) +
                   static_cast<std::size_t>(c)];
  }
  [[nodiscard]] int column(double x_m) const;
  [[nodiscard]] int row(double y_m) const;
  [[nodiscard]] bool empty() const { return levels_.empty(); }

 private:
  struct Level {
    int margin = 0;  // cells before the first one of the map
    int columns = 0;
    int rows = 0;
    std::vector<std::uint8_t> cells;
  };
  Eigen::Vector2d origin_m_ = Eigen::Vector2d::Zero();
  std::vector<Level> levels_;
};

struct CoarseMatch {
  geometry::Pose2 T_map_points;
  double score = 0.0;  ///< mean of CoarseMap::at over the points, as a share of 255
};

/// Extent of a search, in the frame of the map.
struct CoarseWindow {
  geometry::Pose2 centre;
  Eigen::Vector3d half_width = Eigen::Vector3d::Zero();  ///< m, m, rad
};

/// The best places whose score is at least `least` and 85 % of the best one's, best first, at least
/// 0.75 m or 0.3 rad apart, at most `count`; none in a window that is not finite. The same input
/// gives the same bits.
std::vector<CoarseMatch> search_coarsely(const CoarseMap& map,
                                         std::span<const Eigen::Vector2d> points_m,
                                         const CoarseWindow& window, double least,
                                         std::size_t count);

}  // namespace topogeo::localization
