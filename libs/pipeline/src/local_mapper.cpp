#include "topogeo/pipeline/local_mapper.hpp"

#include <cmath>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::pipeline {

using geometry::Pose2;
using topomap::LocalMap;
using topomap::ScanPoint;

LocalMapper::LocalMapper(const LocalMapperConfig& config, std::string robot_id)
    : config_(config),
      robot_id_(std::move(robot_id)),
      tracker_(config.tracker),
      diagram_maker_(config.voronoi) {}

std::optional<LocalMap> LocalMapper::add(const scan::Scan& scan) {
  if (next_id_ == 0) return make_stop(scan, Pose2{});
  const localization::TrackedPose pose = tracker_.track(points_of(scan), scan.T_odom_robot);
  const Pose2& T = pose.T_stop_robot;
  // A scan that cannot be placed against the stop needs the wider search that only stops get.
  // Where scans are sparse, waiting for one more would put the next stop far beyond the wanted
  // distance.
  const Pose2 T_last = track_.empty() ? Pose2{} : track_.back().T_stop_robot;
  const double step_m = std::sqrt((T.position_m() - T_last.position_m()).squaredNorm());
  const double turn_rad = std::fabs(geometry::wrap_angle(T.theta_rad - T_last.theta_rad));
  const double way_m = std::sqrt(T.position_m().squaredNorm());
  const bool stop = !pose.matched || way_m + 0.5 * step_m >= config_.stop_distance_m ||
                    std::fabs(T.theta_rad) + 0.5 * turn_rad >= config_.stop_turn_rad ||
                    track_.size() + 1 >= config_.longest_track;
  if (stop) return make_stop(scan, T);
  track_.push_back({scan.sequence, scan.stamp_ns, scan.T_odom_robot, T, pose.matched});
  last_ = scan;
  return std::nullopt;
}

std::optional<LocalMap> LocalMapper::finish() {
  if (!last_) return std::nullopt;
  const scan::Scan scan = *std::exchange(last_, std::nullopt);
  const Pose2 T_stop_robot = track_.back().T_stop_robot;
  track_.pop_back();
  return make_stop(scan, T_stop_robot);
}

LocalMap LocalMapper::make_stop(const scan::Scan& scan, const Pose2& T_stop_robot) {
  LocalMap map;
  map.robot_id = robot_id_;
  map.id = next_id_++;
  map.sequence = scan.sequence;
  map.stamp_ns = scan.stamp_ns;
  map.T_odom_robot = scan.T_odom_robot;
  map.T_previous_robot = T_stop_robot;
  map.track = std::exchange(track_, {});
  diagram_maker_.compute(scan, diagram_);
  topomap::build_local_map(diagram_, scan, config_.T_robot_laser, config_.local_map, map);
  last_.reset();
  tracker_.start(map.points, config_.T_robot_laser, scan.T_odom_robot);
  return map;
}

std::vector<ScanPoint> LocalMapper::points_of(const scan::Scan& scan) const {
  std::vector<ScanPoint> points;
  points.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    if (!(range_m > 0.0) || range_m > config_.local_map.range_limit_m) continue;
    const geometry::SinCos beam =
        geometry::sincos(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    const Eigen::Vector2d p =
        config_.T_robot_laser * Eigen::Vector2d(range_m * beam.cos, range_m * beam.sin);
    points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y())});
  }
  return points;
}

}  // namespace topogeo::pipeline
