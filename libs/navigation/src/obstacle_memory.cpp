#include "obstacle_memory.hpp"

#include "scan_occupancy.hpp"

namespace topogeo::navigation {

void ObstacleMemory::add(const ScanPoints& scan, const geometry::Pose2& T_map_robot,
                         const planning::FreeSpace& space) {
  const planning::GridFrame& frame = space.frame();
  const ScanOccupancy occupancy(scan);
  const geometry::Pose2 T_robot_map = inverse(T_map_robot);
  const auto forgotten_ns = static_cast<std::int64_t>(config_.forgotten_s * 1e9);
  constexpr int kMisses = 3;  // a beam may pass beside a thin leg
  for (auto entry = cells_.begin(); entry != cells_.end();) {
    Obstacle& obstacle = entry->second;
    if (occupancy.at(T_robot_map * obstacle.point_m, 0.5 * frame.resolution_m) ==
        Occupancy::kFree) {
      ++obstacle.misses;
    }
    const bool gone = obstacle.misses >= (obstacle.hits < kMisses ? 1 : kMisses) ||
                      scan.stamp_ns - obstacle.last_ns > forgotten_ns;
    entry = gone ? cells_.erase(entry) : std::next(entry);
  }
  for (const Eigen::Vector2d& seen_m : scan.points_m) {
    const double range_m = seen_m.norm();
    if (range_m > config_.farthest_m) continue;
    const Eigen::Vector2d point_m = T_map_robot * seen_m;
    const auto cell = frame.cell_of(point_m);
    if (!cell || space.grid().at(*cell) != planning::CellState::kFree) continue;
    if (space.clearance_m(*cell) < config_.tolerance_m + config_.tolerance_rad * range_m) continue;
    Obstacle& obstacle = cells_[frame.index(*cell)];
    if (obstacle.hits == 0) obstacle.first_ns = scan.stamp_ns;
    if (obstacle.hits == 0 || obstacle.last_ns != scan.stamp_ns) ++obstacle.hits;
    obstacle.point_m = point_m;
    obstacle.last_ns = scan.stamp_ns;
    obstacle.misses = 0;
    const double age_s = static_cast<double>(scan.stamp_ns - obstacle.first_ns) * 1e-9;
    if (age_s >= config_.stands_s && obstacle.hits > 2) obstacle.stands = true;
  }
}

std::vector<Obstacle> ObstacleMemory::all() const {
  std::vector<Obstacle> obstacles;
  for (const auto& [index, obstacle] : cells_) {
    if (obstacle.hits > 1) obstacles.push_back(obstacle);
  }
  return obstacles;
}

}  // namespace topogeo::navigation
