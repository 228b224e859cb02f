// Distance of an outline at a pose from everything that it must not touch.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/outline_planner.hpp"

namespace topogeo::planning {

class OutlineField {
 public:
  OutlineField(const FreeSpace& space, std::span<const Eigen::Vector2d> obstacles_m,
               const OutlineConfig& config);

  /// Distance of a point (map frame) from the centre of the nearest occupied cell, interpolated;
  /// metres, 0 outside of the grid.
  [[nodiscard]] double distance_m(const Eigen::Vector2d& point_m) const;
  [[nodiscard]] double distance_m(std::size_t cell) const { return distance_m_[cell]; }

  /// Least distance of the outline at a pose; at most wished_m.
  [[nodiscard]] double clearance_m(const geometry::Pose2& T_map_robot) const;

  [[nodiscard]] const GridFrame& frame() const { return frame_; }

 private:
  GridFrame frame_;
  std::vector<float> distance_m_;
  std::vector<Eigen::Vector2d> points_m_;  // robot frame, over the whole body
  double around_m_ = 0.0;                  // radius around all of them
  double most_m_ = 0.0;
};

}  // namespace topogeo::planning
