#include "topogeo/pipeline/local_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/support/hash.hpp"

namespace topogeo::pipeline {

using geometry::Pose2;
using topomap::LocalMap;
using topomap::ScanPoint;

namespace {

// A scan that cannot be placed makes a stop once the robot has moved this far: a covered laser on a
// standing robot makes none.
constexpr double kLostStop_m = 0.1;
constexpr double kLostStop_rad = 0.05;

// Share of the distance between stops after which odometry alone makes a stop: a tracked pose that
// stays behind must not keep the robot without one.
constexpr double kFarthestByOdometry = 1.5;

// Never 0, which means no session.
std::uint64_t session_of(const scan::Scan& scan, const std::string& robot_id, std::uint64_t salt) {
  support::Fnv1a hash;
  hash.add(robot_id);
  hash.add(salt);
  hash.add(scan::fingerprint(scan));
  return std::max<std::uint64_t>(hash.value(), 1);
}

}  // namespace

LocalMapper::LocalMapper(const LocalMapperConfig& config, std::string robot_id,
                         std::uint64_t session_salt)
    : config_(config),
      robot_id_(std::move(robot_id)),
      tracker_(config.tracker),
      carried_(config.tracker, config.T_robot_laser),
      diagram_maker_(config.voronoi),
      map_builder_(config.local_map),
      session_salt_(session_salt),
      track_(config.longest_track) {}

std::optional<LocalMap> LocalMapper::add(const scan::Scan& scan) {
  if (next_.number == 0) return begin_session(scan);
  if (scan.odometry_epoch != odometry_epoch_) {
    odometry_epoch_ = scan.odometry_epoch;
    const std::optional<Pose2> T_stop_robot = find_again(scan);
    return T_stop_robot ? make_stop(scan, *T_stop_robot) : begin_session(scan);
  }
  const std::vector<ScanPoint> points = points_of(scan);
  const localization::TrackedPose pose = tracker_.track(points, scan.T_odom_robot);
  const Pose2& T = pose.T_stop_robot;
  const CarriedWatch::State carried = carried_.add(scan, points, pose);
  if (carried == CarriedWatch::State::kElsewhere) return begin_session(scan);
  if (is_stop(pose, carried == CarriedWatch::State::kUnclear)) return make_stop(scan, T);
  track_.add({scan.sequence, scan.stamp_ns, scan.T_odom_robot, T, pose.matched});
  last_ = scan;
  return std::nullopt;
}

bool LocalMapper::is_stop(const localization::TrackedPose& pose, bool maybe_carried) const {
  const double driven_m = std::sqrt(pose.T_stop_odometry.position_m().squaredNorm());
  const bool far_by_odometry = driven_m >= kFarthestByOdometry * config_.stop_distance_m;
  if (maybe_carried) return far_by_odometry;
  const Pose2& T = pose.T_stop_robot;
  // A scan that cannot be placed relative to the stop needs the wider search that only stops get,
  // but a covered laser must not make a stop of every scan. If scans are sparse, waiting for one
  // more would put the next stop far beyond the wanted distance.
  const Pose2 T_last = track_.empty() ? Pose2{} : track_.last().T_stop_robot;
  const double step_m = std::sqrt((T.position_m() - T_last.position_m()).squaredNorm());
  const double turn_rad = std::fabs(geometry::wrap_angle(T.theta_rad - T_last.theta_rad));
  const double distance_m = std::sqrt(T.position_m().squaredNorm());
  const bool lost =
      !pose.matched && (distance_m >= kLostStop_m || std::fabs(T.theta_rad) >= kLostStop_rad);
  return lost || far_by_odometry || distance_m + 0.5 * step_m >= config_.stop_distance_m ||
         std::fabs(T.theta_rad) + 0.5 * turn_rad >= config_.stop_turn_rad;
}

std::optional<LocalMap> LocalMapper::finish() {
  if (!last_) return std::nullopt;
  const scan::Scan scan = *std::exchange(last_, std::nullopt);
  const Pose2 T_stop_robot = track_.last().T_stop_robot;
  track_.drop_last();
  return make_stop(scan, T_stop_robot);
}

// Searches ahead too: a base without commands drives on until its watchdog stops it.
std::optional<Pose2> LocalMapper::find_again(const scan::Scan& scan) const {
  constexpr double kFarthest_m = 1.25;
  constexpr double kStep_m = 0.25;  // a match covers the distance between two starts
  const std::vector<ScanPoint> points = points_of(scan);
  localization::TrackedPose best;
  for (double ahead_m = 0.0; ahead_m <= kFarthest_m; ahead_m += kStep_m) {
    localization::ScanTracker tracker = tracker_;
    tracker.restart_odometry(scan.T_odom_robot, {ahead_m, 0.0, 0.0});
    const localization::TrackedPose pose = tracker.track(points, scan.T_odom_robot);
    if (pose.matched && pose.agreement > best.agreement) best = pose;
  }
  if (!best.matched) return std::nullopt;
  return best.T_stop_robot;
}

LocalMap LocalMapper::begin_session(const scan::Scan& scan) {
  next_ = {session_of(scan, robot_id_, session_salt_), 0};
  odometry_epoch_ = scan.odometry_epoch;
  track_.take();
  return make_stop(scan, Pose2{});
}

void LocalMapper::resume(const LocalMap& last_stop) {
  next_ = last_stop.stop.next();
  odometry_epoch_ = last_stop.odometry_epoch;
  tracker_.start(last_stop.points, last_stop.T_robot_laser, last_stop.T_odom_robot);
}

LocalMap LocalMapper::make_stop(const scan::Scan& scan, const Pose2& T_stop_robot) {
  LocalMap map;
  map.robot_id = robot_id_;
  map.id = next_.number;
  map.stop = next_;
  next_ = next_.next();
  map.sequence = scan.sequence;
  map.stamp_ns = scan.stamp_ns;
  map.T_odom_robot = scan.T_odom_robot;
  map.odometry_epoch = scan.odometry_epoch;
  map.T_previous_robot = T_stop_robot;
  map.track = track_.take();
  diagram_maker_.compute(scan, diagram_);
  map_builder_.build(diagram_, scan, config_.T_robot_laser, map);
  last_.reset();
  tracker_.start(map.points, config_.T_robot_laser, scan.T_odom_robot);
  carried_.start(scan);
  return map;
}

std::vector<ScanPoint> LocalMapper::points_of(const scan::Scan& scan) const {
  return topomap::scan_points(scan, config_.T_robot_laser, config_.local_map.points_range_m);
}

}  // namespace topogeo::pipeline
