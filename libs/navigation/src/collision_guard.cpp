#include "topogeo/navigation/collision_guard.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/outline_sweep.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/support/format.hpp"

#include "scan_smoothing.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kStanding_m_s = 1e-6;  // slower motion counts as none
constexpr double kNsToSeconds = 1e-9;
constexpr double kRolls_m_s = 0.05;     // below this it stops at once
constexpr double kLargestLead_s = 1.0;  // of a stamp: more than clocks of one robot differ

bool has_echo(const SonarReading& reading) {
  return reading.range_m > scan::Scan::kNoReturn;
}

std::string describe_contact(bool is_drawn, double free_m, bool ahead) {
  constexpr double kTouches_m = 0.01;
  const char* what = is_drawn ? "a drawn wall or no-go zone" : "something";
  if (free_m < kTouches_m) {
    return fmt::format("{} is right {} the body", what, ahead ? "in front of" : "behind");
  }
  return fmt::format("{} is {:.2f} m {} the body", what, free_m, ahead ? "ahead of" : "behind");
}

/// Notes where the body touches something, the contact being an index of `points_m`; returns
/// whether it is a drawn place, which those from `standing` on are.
bool note_contact(GuardVerdict& verdict, const std::optional<std::size_t>& contact,
                  const std::vector<Eigen::Vector2d>& points_m, std::size_t standing) {
  const bool is_drawn = contact && *contact >= standing;
  if (contact && !is_drawn) verdict.contact_m = points_m[*contact];
  return is_drawn;
}

void refuse_backward(GuardVerdict& verdict) {
  verdict.allowed = {};
  verdict.limited = true;
  verdict.reason = HaltReason::kSonarSilent;
  verdict.message = "backward motion needs a fresh sonar reading";
}

/// Allows a speed below the wanted one, or none where it is less than bases go.
void slow_down(GuardVerdict& verdict, double speed, double asked) {
  constexpr double kCreep_m_per_s = 0.01;
  verdict.limited = true;
  verdict.allowed.linear_m_per_s *= speed / asked;
  verdict.allowed.angular_rad_per_s *= speed / asked;
  if (speed < kCreep_m_per_s) {
    verdict.allowed = {};
    verdict.reason = HaltReason::kObstacle;
  }
}

}  // namespace

CollisionGuard::CollisionGuard(const GuardConfig& config) : config_(config) {
  check(config);
}

void CollisionGuard::add(const OdometrySample& odometry) {
  if (odometry_.add({odometry.stamp_ns, odometry.T_odom_robot})) last_ = odometry;
}

void CollisionGuard::add(const ScanPoints& scan) {
  if (scan_ && scan.stamp_ns <= scan_->stamp_ns) return;
  scan_ = smoothed(scan, config_.side_margin_m);
  compare_echoes();
}

void CollisionGuard::add(const SonarRound& sonar) {
  if (sonar_ && sonar.stamp_ns <= sonar_->stamp_ns) return;
  sonar_ = sonar;
  T_odom_sonar_round_.reset();
  if (const auto answer = odometry_.at(sonar.stamp_ns)) {
    T_odom_sonar_round_ = answer->T_odom_robot;
  } else if (last_) {
    T_odom_sonar_round_ = last_->T_odom_robot;
  }
  watch_silence(sonar);
  compare_echoes();
}

void CollisionGuard::add(const LaserFields& fields) {
  if (!fields_ || fields.stamp_ns > fields_->stamp_ns) fields_ = fields;
}

void CollisionGuard::keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
  drawn_m_ = std::move(points_m);
  if (drawn_m_.empty()) return;
  if (const auto then = odometry_.at(stamp_ns)) {
    T_odom_drawn_ = then->T_odom_robot;
  } else {
    T_odom_drawn_ = last_ ? last_->T_odom_robot : geometry::Pose2{};
  }
}

void CollisionGuard::add_drawn(std::vector<Eigen::Vector2d>& points_m) const {
  constexpr double kCarried_m = 3.0;  // the distance that a navigator drives without a certain pose
  if (drawn_m_.empty() || !last_) return;
  const geometry::Pose2 T_now_then = between(last_->T_odom_robot, T_odom_drawn_);
  if (T_now_then.position_m().norm() > kCarried_m) return;
  for (const Eigen::Vector2d& point_m : drawn_m_) points_m.push_back(T_now_then * point_m);
}

// Records since when the sonars have no echo although the laser sees something in their reach.
void CollisionGuard::watch_silence(const SonarRound& sonar) {
  const bool any = std::any_of(sonar.readings.begin(), sonar.readings.end(), has_echo);
  const auto needs_echo = [&](const SonarReading& reading) {
    return laser_sees(reading, config_.sonar_reach_m);
  };
  if (any || !scan_ || !fresh(scan_->stamp_ns, sonar.stamp_ns) ||
      !std::any_of(sonar.readings.begin(), sonar.readings.end(), needs_echo)) {
    silent_since_ns_.reset();
  } else if (!silent_since_ns_) {
    silent_since_ns_ = sonar.stamp_ns;
  }
}

// The echoes of the sonars, and whether the laser also sees, more exactly, what they come from.
void CollisionGuard::compare_echoes() {
  constexpr double kSame_m = 0.2;  // error of both, for the same object
  constexpr double kAhead = 0.5;   // within 60 degrees of ahead or back
  echoes_.clear();
  if (!sonar_) return;
  for (const SonarReading& reading : sonar_->readings) {
    if (!has_echo(reading)) continue;
    const double range_m = static_cast<double>(reading.range_m);
    // A least reading beside the body is a door post, which the motion does not bring nearer.
    const bool ahead = std::fabs(geometry::sincos(reading.T_robot_sonar.theta_rad).cos) > kAhead;
    const double away_m = ahead && range_m <= config_.sonar_least_m ? 0.0 : range_m;
    echoes_.push_back({reading.T_robot_sonar * Eigen::Vector2d(away_m, 0.0),
                       scan_ && laser_sees(reading, range_m + kSame_m)});
  }
}

bool CollisionGuard::laser_sees(const SonarReading& reading, double up_to_m) const {
  const geometry::Pose2 T_sonar_robot = inverse(reading.T_robot_sonar);
  const double tangent = std::tan(std::min(reading.half_cone_rad, 1.5));  // not used for mapping
  return std::any_of(scan_->points_m.begin(), scan_->points_m.end(), [&](const auto& point_m) {
    const Eigen::Vector2d seen_m = T_sonar_robot * point_m;
    return seen_m.x() > 0.0 && std::fabs(seen_m.y()) <= tangent * seen_m.x() &&
           seen_m.norm() <= up_to_m;
  });
}

bool CollisionGuard::fresh(std::int64_t stamp_ns, std::int64_t now_ns) const {
  const double age_s = static_cast<double>(now_ns - stamp_ns) * kNsToSeconds;
  // A measurement from the future belongs to a clock that was set back since.
  return age_s <= config_.oldest_scan_s && age_s >= -kLargestLead_s;
}

HaltReason CollisionGuard::health(std::int64_t now_ns, std::string* message) const {
  const auto because = [&](HaltReason reason, std::string text) {
    if (message != nullptr) *message = std::move(text);
    return reason;
  };
  const auto age_s = [&](std::int64_t stamp_ns) {
    return static_cast<double>(now_ns - stamp_ns) * kNsToSeconds;
  };
  if (config_.needs_scan && !scan_) return because(HaltReason::kNoScan, "no scan received yet");
  if (config_.needs_scan && !fresh(scan_->stamp_ns, now_ns)) {
    return because(HaltReason::kNoScan,
                   fmt::format("the last scan is {:.1f} s old", age_s(scan_->stamp_ns)));
  }
  const bool needs_sonar = config_.needs_sonar || !config_.needs_scan;
  if (needs_sonar && (!sonar_ || sonar_->readings.empty())) {
    return because(HaltReason::kSonarSilent, "no sonar reading received yet");
  }
  if (needs_sonar && age_s(sonar_->stamp_ns) > std::max(config_.silent_s, config_.oldest_scan_s)) {
    return because(HaltReason::kSonarSilent,
                   fmt::format("the last sonar reading is {:.1f} s old", age_s(sonar_->stamp_ns)));
  }
  if (silent_since_ns_ && age_s(sonar_->stamp_ns) <= config_.silent_s &&
      static_cast<double>(sonar_->stamp_ns - *silent_since_ns_) * kNsToSeconds >=
          config_.silent_s) {
    return because(HaltReason::kSonarSilent,
                   fmt::format("no sonar echo for {:.1f} s, though the laser sees something near",
                               age_s(*silent_since_ns_)));
  }
  return HaltReason::kNone;
}

std::vector<Eigen::Vector2d> CollisionGuard::obstacles_m(std::int64_t now_ns) const {
  std::vector<Eigen::Vector2d> points_m;
  const auto carried = [&](const geometry::Pose2& T_odom_then) {
    return last_ ? between(last_->T_odom_robot, T_odom_then) : geometry::Pose2{};
  };
  const bool scan_counts = scan_ && fresh(scan_->stamp_ns, now_ns);
  if (scan_counts) {
    const geometry::Pose2 T_now_then = carried(scan_->T_odom_robot);
    for (const Eigen::Vector2d& point_m : scan_->points_m) points_m.push_back(T_now_then * point_m);
  }
  if (!sonar_ || !fresh(sonar_->stamp_ns, now_ns)) return points_m;
  const geometry::Pose2 T_now_then =
      T_odom_sonar_round_ ? carried(*T_odom_sonar_round_) : geometry::Pose2{};
  for (const Echo& echo : echoes_) {
    if (!scan_counts || !echo.laser_sees) points_m.push_back(T_now_then * echo.point_m);
  }
  return points_m;
}

geometry::Velocity CollisionGuard::driven() const {
  if (!last_) return {};
  constexpr std::int64_t kOver_ns = 150'000'000;  // shorter times turn odometry noise into speed
  for (std::int64_t back_ns = kOver_ns; back_ns >= 10'000'000; back_ns /= 2) {
    const auto before = odometry_.at(last_->stamp_ns - back_ns);
    if (!before) continue;
    const geometry::Pose2 step = between(before->T_odom_robot, last_->T_odom_robot);
    const double time_s = static_cast<double>(back_ns) * kNsToSeconds;
    return {step.x_m / time_s, step.theta_rad / time_s};
  }
  return {};
}

// Obstacles are carried on to the newest odometry; the robot has moved since then.
double CollisionGuard::reaction_s(std::int64_t now_ns) const {
  std::int64_t seen_ns = now_ns;
  if (last_) {
    seen_ns = last_->stamp_ns;
  } else if (scan_ || sonar_) {
    seen_ns = scan_ ? scan_->stamp_ns : sonar_->stamp_ns;
  }
  const double age_s = std::max(0.0, static_cast<double>(now_ns - seen_ns) * kNsToSeconds);
  return age_s + config_.delay_s + config_.runs_on_s;
}

double CollisionGuard::speed_for(double free_m, double reaction_s) const {
  const double kept_m = std::max(0.0, config_.margin_m - config_.side_margin_m);
  return stopping_speed(free_m - kept_m, reaction_s, config_.deceleration_m_per_s2);
}

GuardVerdict CollisionGuard::judge(const geometry::Velocity& wanted, std::int64_t now_ns) const {
  const geometry::Velocity possible = geometry::drivable(wanted, config_.minimum_turning_radius_m);
  GuardVerdict verdict = judge_by_distances(possible, now_ns);
  if (config_.laser_fields && fields_) obey_fields(verdict);
  if (possible == wanted || verdict.reason != HaltReason::kNone) return verdict;
  verdict.limited = true;
  if (possible == geometry::Velocity{}) {
    verdict.reason = HaltReason::kBaseNotReady;
    verdict.message = fmt::format(
        "the drive unit cannot turn on the spot: its smallest turning radius is {:.2f} m",
        config_.minimum_turning_radius_m);
  }
  return verdict;
}

void CollisionGuard::obey_fields(GuardVerdict& verdict) const {
  const double ahead = verdict.allowed.linear_m_per_s;
  if (ahead < kStanding_m_s || !(fields_->warning || fields_->protective)) return;
  const double most = fields_->protective ? 0.0 : config_.warning_field_m_per_s;
  if (ahead <= most) return;
  verdict.limited = true;
  verdict.allowed.linear_m_per_s *= most / ahead;
  verdict.allowed.angular_rad_per_s *= most / ahead;
  verdict.message = "something is in the warning field of the laser";
  if (!fields_->protective) return;
  verdict.reason = HaltReason::kObstacle;
  verdict.message = "something is in the protective field of the laser";
}

GuardVerdict CollisionGuard::judge_by_distances(const geometry::Velocity& wanted,
                                                std::int64_t now_ns) const {
  GuardVerdict verdict;
  verdict.reason = health(now_ns, &verdict.message);
  if (verdict.reason != HaltReason::kNone) {
    verdict.limited = wanted != geometry::Velocity{};
    return verdict;
  }
  if (!config_.footprint.empty()) {
    judge_outline(wanted, now_ns, verdict);
    return verdict;
  }
  std::vector<Eigen::Vector2d> points_m = obstacles_m(now_ns);
  const std::size_t standing = points_m.size();
  add_drawn(points_m);
  const double body_m = config_.radius_m + std::min(config_.margin_m, config_.side_margin_m);
  const bool still = std::fabs(wanted.linear_m_per_s) < kStanding_m_s;
  const SweptArc arc =
      sweep(still ? geometry::Velocity{1.0, 0.0} : wanted, points_m, body_m, kFarthest_m);
  verdict.free_m = arc.length_m;
  const bool is_drawn = note_contact(verdict, arc.contact, points_m, standing);
  verdict.allowed = wanted;
  if (still) return verdict;
  if (wanted.linear_m_per_s < 0.0 && (!sonar_ || !fresh(sonar_->stamp_ns, now_ns))) {
    refuse_backward(verdict);
    return verdict;
  }
  const double late_s = reaction_s(now_ns);
  double speed = speed_for(arc.length_m, late_s);
  const geometry::Velocity now = driven();
  if (std::fabs(now.linear_m_per_s) > kRolls_m_s &&
      (now.linear_m_per_s > 0.0) == (wanted.linear_m_per_s > 0.0)) {
    speed = std::min(speed, speed_for(sweep(now, points_m, body_m, kFarthest_m).length_m, late_s));
  }
  const double asked = std::fabs(wanted.linear_m_per_s);
  if (speed >= asked) return verdict;
  slow_down(verdict, speed, asked);
  verdict.message = describe_contact(is_drawn, arc.length_m, wanted.linear_m_per_s > 0.0);
  return verdict;
}

void CollisionGuard::judge_outline(const geometry::Velocity& wanted, std::int64_t now_ns,
                                   GuardVerdict& verdict) const {
  const geometry::Footprint& body = config_.footprint;
  std::vector<Eigen::Vector2d> points_m = obstacles_m(now_ns);
  const std::size_t standing = points_m.size();
  add_drawn(points_m);
  const double margin_m = std::min(config_.margin_m, config_.side_margin_m);
  const double asked = outline_speed(wanted, body);
  const bool still = std::fabs(wanted.linear_m_per_s) < kStanding_m_s;
  const OutlineSweep swept = sweep(wanted, points_m, body, margin_m, kFarthest_m);
  verdict.free_m =
      still ? sweep({1.0, 0.0}, points_m, body, margin_m, kFarthest_m).length_m : swept.length_m;
  const bool is_drawn = note_contact(verdict, swept.contact, points_m, standing);
  verdict.allowed = wanted;
  if (asked < kStanding_m_s) return;
  if (wanted.linear_m_per_s < -kStanding_m_s && (!sonar_ || !fresh(sonar_->stamp_ns, now_ns))) {
    refuse_backward(verdict);
    return;
  }
  const double late_s = reaction_s(now_ns);
  double speed = speed_for(swept.reach_m, late_s);
  const geometry::Velocity now = driven();
  const double arm_m = geometry::circumscribed_radius_m(body);
  const bool goes_on = now.linear_m_per_s * wanted.linear_m_per_s +
                           arm_m * arm_m * now.angular_rad_per_s * wanted.angular_rad_per_s >
                       0.0;
  if (goes_on && outline_speed(now, body) > kRolls_m_s) {
    speed = std::min(speed,
                     speed_for(sweep(now, points_m, body, margin_m, kFarthest_m).reach_m, late_s));
  }
  if (speed >= asked) return;
  slow_down(verdict, speed, asked);
  verdict.message = still ? "no room to turn on the spot"
                          : describe_contact(is_drawn, swept.length_m, wanted.linear_m_per_s > 0.0);
}

}  // namespace topogeo::navigation
