#include "outline_field.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::planning {
namespace {

constexpr float kFar_m = 100.0F;

// The floor of a map with everything that an outline must not touch as occupied cells.
FreeSpace with_obstacles(const FreeSpace& space, std::span<const Eigen::Vector2d> obstacles_m) {
  OccupancyGrid grid = space.grid();
  for (const Cell& cell : space.rules().no_go()) grid.set(cell, CellState::kOccupied);
  for (const Eigen::Vector2d& obstacle_m : obstacles_m) {
    if (const auto cell = grid.frame().cell_of(obstacle_m)) grid.set(*cell, CellState::kOccupied);
  }
  InflationConfig inflation = space.inflation();
  inflation.min_pocket_m2 = 0.0;
  return FreeSpace(std::move(grid), inflation);
}

}  // namespace

OutlineField::OutlineField(const FreeSpace& space, std::span<const Eigen::Vector2d> obstacles_m,
                           const OutlineConfig& config)
    : frame_(space.frame()),
      points_m_(geometry::covering_points_m(config.footprint, space.frame().resolution_m)),
      around_m_(geometry::circumscribed_radius_m(config.footprint)),
      most_m_(config.wished_m) {
  const FreeSpace filled = with_obstacles(space, obstacles_m);
  distance_m_.resize(frame_.size());
  for (std::size_t i = 0; i < distance_m_.size(); ++i) {
    const std::int32_t squared = filled.squared_cells(i);
    distance_m_[i] =
        squared == FreeSpace::kNoObstacle
            ? kFar_m
            : static_cast<float>(std::sqrt(static_cast<double>(squared)) * frame_.resolution_m);
  }
}

double OutlineField::distance_m(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d at = frame_.in_cells(point_m) - Eigen::Vector2d(0.5, 0.5);
  const double left = std::floor(at.x());
  const double low = std::floor(at.y());
  if (!(left >= 0.0 && low >= 0.0 && left + 1.0 < frame_.columns && low + 1.0 < frame_.rows)) {
    return 0.0;
  }
  const std::size_t i =
      frame_.index({static_cast<std::int32_t>(left), static_cast<std::int32_t>(low)});
  const auto columns = static_cast<std::size_t>(frame_.columns);
  const double x = at.x() - left;
  const double y = at.y() - low;
  const double below = (1.0 - x) * double{distance_m_[i]} + x * double{distance_m_[i + 1]};
  const double above =
      (1.0 - x) * double{distance_m_[i + columns]} + x * double{distance_m_[i + columns + 1]};
  return (1.0 - y) * below + y * above;
}

double OutlineField::clearance_m(const geometry::Pose2& T_map_robot) const {
  const double centre_m = distance_m(T_map_robot.position_m());
  double least_m = most_m_;
  if (centre_m > around_m_ + most_m_) return least_m;
  const geometry::SinCos heading = geometry::sincos(T_map_robot.theta_rad);
  for (const Eigen::Vector2d& p : points_m_) {
    const Eigen::Vector2d at_m(T_map_robot.x_m + heading.cos * p.x() - heading.sin * p.y(),
                               T_map_robot.y_m + heading.sin * p.x() + heading.cos * p.y());
    least_m = std::min(least_m, distance_m(at_m));
    if (least_m <= 0.0) return 0.0;
  }
  return least_m;
}

}  // namespace topogeo::planning
