#include "topogeo/navigation/last_guard.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/outline_sweep.hpp"

#include "scan_smoothing.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kStandingSpeed = 1e-6;  // m/s; slower motion counts as none
constexpr double kSecondsPerNs = 1e-9;
constexpr double kSight_m = 5.0;  // no guarded base needs more to stop
/// m; laser noise left after smoothing, less than a collision guard keeps.
constexpr double kNoise_m = 0.015;
constexpr double kSlowest = 0.01;  // m/s; bases do not move slower
constexpr double kRolls = 0.05;    // m/s; below this it stops at once
/// s; between two judgements, kPeriod_ns, and the orders on the serial line. A collision guard
/// counts twice as much, because its commands travel first.
constexpr double kDelay_s = 0.1;
/// A scan may be this much newer than the odometry, which is extrapolated by its speeds.
constexpr std::int64_t kScanAhead_ns = 500'000'000;

}  // namespace

LastGuard::LastGuard(const GuardConfig& config, double runs_on_s)
    : config_(config), runs_on_s_(runs_on_s), track_(kScanAhead_ns) {
  check(config);
}

void LastGuard::add(const geometry::OdometrySample& odometry) {
  if (track_.add(odometry)) last_ = odometry;
}

void LastGuard::add(const ScanPoints& scan) {
  if (scan_ && scan.stamp_ns <= scan_->stamp_ns) return;
  if (repeats(scan)) return;
  scan_ = smoothed(scan, config_.side_margin_m);
}

bool LastGuard::repeats(const ScanPoints& scan) {
  constexpr double kMoved_m = 0.01;
  constexpr double kMoved_rad = 0.005;
  const geometry::Pose2 T_odom_now = last_ ? last_->T_odom_robot : geometry::Pose2{};
  if (scan.points_m.empty() || scan.points_m != seen_m_) {
    seen_m_ = scan.points_m;
    T_odom_seen_ = T_odom_now;
    return false;
  }
  const geometry::Pose2 moved = geometry::between(T_odom_seen_, T_odom_now);
  return moved.position_m().norm() > kMoved_m || std::fabs(moved.theta_rad) > kMoved_rad;
}

bool LastGuard::sees(std::int64_t now_ns) const {
  if (!last_ || !scan_) return false;
  const double age_s = static_cast<double>(now_ns - scan_->stamp_ns) * kSecondsPerNs;
  // A stamp far ahead comes from a wrong clock, and the age of its scan is unknown.
  return std::fabs(age_s) <= config_.oldest_scan_s;
}

std::vector<Eigen::Vector2d> LastGuard::points_now_m() const {
  const auto then = track_.at(scan_->stamp_ns);
  const geometry::Pose2& T_odom_then = then ? then->T_odom_robot : last_->T_odom_robot;
  const geometry::Pose2 T_now_then = geometry::between(last_->T_odom_robot, T_odom_then);
  std::vector<Eigen::Vector2d> points_m;
  points_m.reserve(scan_->points_m.size());
  for (const Eigen::Vector2d& point_m : scan_->points_m) points_m.push_back(T_now_then * point_m);
  return points_m;
}

double LastGuard::swept_m(const geometry::Velocity& motion,
                          const std::vector<Eigen::Vector2d>& points_m) const {
  const double margin_m = std::min(kNoise_m, config_.side_margin_m);
  if (config_.footprint.empty()) {
    return sweep(motion, points_m, config_.radius_m + margin_m, kSight_m).length_m;
  }
  return sweep(motion, points_m, config_.footprint, margin_m, kSight_m).reach_m;
}

LastGuard::Judgement LastGuard::judge(const geometry::Velocity& asked_for, double brake_m_per_s2,
                                      std::int64_t now_ns) const {
  const geometry::Velocity wanted = geometry::drivable(asked_for, config_.minimum_turning_radius_m);
  const double asked = config_.footprint.empty() ? std::fabs(wanted.linear_m_per_s)
                                                 : outline_speed(wanted, config_.footprint);
  if (asked < kStandingSpeed) return {wanted, Verdict::kAsWanted, kSight_m};
  if (!sees(now_ns)) {
    if (!config_.needs_scan) return {wanted, Verdict::kAsWanted, kSight_m};
    return {{}, Verdict::kBlind, 0.0};
  }
  const std::vector<Eigen::Vector2d> points_m = points_now_m();
  double free_m = swept_m(wanted, points_m);
  // While changing to another arc, the robot is still on the present one.
  const geometry::Velocity driven{last_->linear_mps, last_->angular_radps};
  const bool turns_on = !config_.footprint.empty() && wanted.linear_m_per_s == 0.0 &&
                        last_->angular_radps * wanted.angular_rad_per_s > 0.0;
  if (turns_on ||
      (std::fabs(last_->linear_mps) > kRolls && last_->linear_mps * wanted.linear_m_per_s > 0.0)) {
    free_m = std::min(free_m, swept_m(driven, points_m));
  }
  const double age_s = std::max(0.0, static_cast<double>(now_ns - last_->stamp_ns) * kSecondsPerNs);
  const double speed = stopping_speed(free_m, age_s + kDelay_s + runs_on_s_,
                                      std::min(config_.deceleration_m_per_s2, brake_m_per_s2));
  if (speed >= asked || free_m >= kSight_m) return {wanted, Verdict::kAsWanted, free_m};
  if (speed < kSlowest) return {{}, Verdict::kObstacle, free_m};
  const double share = speed / asked;
  return {
      {wanted.linear_m_per_s * share, wanted.angular_rad_per_s * share}, Verdict::kSlower, free_m};
}

}  // namespace topogeo::navigation
