// Predicted range of a sonar anywhere on a known grid: the nearest obstacle within its cone, from
// tables made on demand.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/markov/obstacle_cells.hpp"

namespace topogeo::markov {

class ConeRanges {
 public:
  static constexpr int kBearings = 240;  ///< per table, 1.5 degrees apart

  /// `half_cone_rad` in [0, pi/2], `max_range_m` in (0, 60]; throws std::invalid_argument
  /// otherwise. Space outside the map is empty. The map must outlive this.
  ConeRanges(const ObstacleCells& map, double half_cone_rad, double max_range_m);

  /// Distance from a point of the map frame, to half a cell, to the middle of a ray's stretch
  /// through the first obstacle cell, metres; the shortest over the cone around the bearing
  /// (radians). At most max_range_m; 0 in an obstacle.
  [[nodiscard]] double range_m(const Eigen::Vector2d& from_m, double bearing_rad) {
    return 0.001 * static_cast<double>(range_mm(from_m, bearing_index(bearing_rad)));
  }

  /// The same for the index of a table's bearing, in millimetres.
  [[nodiscard]] std::uint16_t range_mm(const Eigen::Vector2d& from_m, int bearing);
  [[nodiscard]] static int bearing_index(double bearing_rad);

  /// Number of tables in memory.
  [[nodiscard]] std::size_t tables() const { return tables_.size(); }

 private:
  using Table = std::array<std::uint16_t, kBearings>;

  [[nodiscard]] Table make(int x, int y) const;
  [[nodiscard]] double ray_m(const Eigen::Vector2d& from_cells, double bearing_rad) const;

  const ObstacleCells& map_;
  int half_bearings_;
  double max_range_m_;
  double step_m_;  ///< side of the squares that share a table
  int columns_;
  int rows_;
  std::vector<std::int32_t> table_of_;  ///< by square; negative: none
  std::vector<Table> tables_;
};

}  // namespace topogeo::markov
