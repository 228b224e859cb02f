#include "driven_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::topomap {
namespace {

// Spacing of the stored places of a branch: half the distance allowed between two views of it.
constexpr double kSpacing_m = 0.25;

std::vector<Eigen::Vector2d> places_seen(const LocalMap& map, const geometry::Pose2& T_map_robot) {
  std::vector<Eigen::Vector2d> places_m;
  for (const LocalBranch& branch : map.branches) {
    if (branch.is_virtual || !branch.in_main_graph) continue;
    const Eigen::Vector2d* last = nullptr;
    for (const BranchPoint& point : branch.points) {
      if (last != nullptr && (point.position_m - *last).norm() < kSpacing_m) continue;
      last = &point.position_m;
      places_m.push_back(point.position_m);
    }
  }
  std::stable_sort(places_m.begin(), places_m.end(),
                   [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                     return a.squaredNorm() < b.squaredNorm();
                   });
  for (Eigen::Vector2d& place_m : places_m) place_m = T_map_robot * place_m;
  return places_m;
}

}  // namespace

double VisitedStop::clearance_m(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d here_m = inverse(T_map_robot) * point_m;
  double nearest_sq = std::numeric_limits<double>::infinity();
  for (const ScanPoint& p : points) {
    nearest_sq = std::min(nearest_sq, (Eigen::Vector2d(p.x_m, p.y_m) - here_m).squaredNorm());
  }
  return points.empty() ? 0.0 : std::sqrt(nearest_sq);
}

void DrivenPath::add(const LocalMap& map, const geometry::Pose2& T_map_robot) {
  VisitedStop stop;
  stop.map_id = map.id;
  stop.T_map_robot = T_map_robot;
  stop.follows = !stops_.empty() && stops_.back().map_id + 1 == map.id && !map.starts_drive;
  if (stop.follows) {
    for (const TrackedScan& scan : map.track) {
      stop.path_m.push_back(stops_.back().T_map_robot * scan.T_stop_robot.position_m());
    }
  }
  stop.points = map.points;
  stop.seen_m = places_seen(map, T_map_robot);
  stops_.push_back(std::move(stop));
}

}  // namespace topogeo::topomap
