#include "surroundings.hpp"

namespace topogeo::navigation {

void Surroundings::add(const ScanPoints& scan) {
  constexpr std::size_t kMost = 10;  // between two steps; more come only if nothing calls step()
  if (scans_.size() < kMost) scans_.push_back(scan);
}

void Surroundings::update(const planning::FreeSpace* space, const PoseKeeper& poses,
                          std::int64_t now_ns) {
  for (const ScanPoints& scan : scans_) {
    if (space == nullptr) break;
    const auto T_map_robot = poses.T_map_robot(scan.stamp_ns);
    if (!T_map_robot) continue;
    memory_.add(scan, *T_map_robot, *space);
    blockade_.see(scan, *T_map_robot);
    if (scan.scan) newest_ = SeenScan{scan.scan, scan.T_robot_laser, *T_map_robot};
  }
  scans_.clear();
  blockade_.expire(now_ns);
}

void Surroundings::forget() {
  memory_.clear();
  contacts_.clear();
  newest_.reset();
}

SeenObstacles Surroundings::seen(std::int64_t now_ns) const {
  SeenObstacles seen;
  const std::vector<Obstacle> obstacles = memory_.all();
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.stands) seen.points_m.push_back(obstacle.point_m);
  }
  const std::vector<Eigen::Vector2d> met_m = contacts_.points_m(now_ns);
  seen.points_m.insert(seen.points_m.end(), met_m.begin(), met_m.end());
  seen.standing = seen.points_m.size();
  for (const Obstacle& obstacle : obstacles) {
    if (!obstacle.stands) seen.points_m.push_back(obstacle.point_m);
  }
  seen.scan = newest_;
  return seen;
}

void Surroundings::report(const Eigen::Vector2d& around_m, double reach_m,
                          const planning::GridFrame& frame, std::int64_t now_ns) {
  std::vector<Eigen::Vector2d> filled_m;
  for (const Eigen::Vector2d& point_m : seen(now_ns).points_m) {
    if ((point_m - around_m).norm() < reach_m) filled_m.push_back(point_m);
  }
  if (!blockade_.add(filled_m, frame, now_ns)) blockade_.ask_again();
}

}  // namespace topogeo::navigation
