// Limits without a real obstacle: drawn walls and no-go zones, as points that a collision guard
// keeps off.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"

namespace topogeo::navigation {

class DrawnLimits {
 public:
  /// More than the guard looks ahead and carries points on without a pose.
  static constexpr double kReach_m = 8.0;

  /// No limits.
  DrawnLimits() = default;
  explicit DrawnLimits(const planning::FreeSpace& space);

  [[nodiscard]] bool empty() const { return walls_m_.empty() && zones_.empty(); }

  /// The middles of cells of walls and of the rims of no-go zones within kReach_m, robot frame. A
  /// zone around the robot's centre does not count, so that a robot inside a newly drawn zone can
  /// leave.
  [[nodiscard]] std::vector<Eigen::Vector2d> near_m(const geometry::Pose2& T_map_robot) const;

 private:
  struct Zone {
    std::vector<planning::Cell> cells;   ///< ascending by row and column
    std::vector<Eigen::Vector2d> rim_m;  ///< map frame
  };

  planning::GridFrame frame_;
  std::vector<Eigen::Vector2d> walls_m_;  ///< map frame
  std::vector<Zone> zones_;
};

}  // namespace topogeo::navigation
