#include "topogeo/navigation/guard_inputs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/support/format.hpp"

#include "scan_smoothing.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kNsToSeconds = 1e-9;
constexpr double kLargestLead_s = 1.0;  // of a stamp: more than clocks of one robot differ

bool has_echo(const SonarReading& reading) {
  return reading.range_m > scan::Scan::kNoReturn;
}

}  // namespace

void GuardInputs::add(const OdometrySample& odometry) {
  if (odometry_.add({odometry.stamp_ns, odometry.T_odom_robot})) last_ = odometry;
}

void GuardInputs::add(const ScanPoints& scan) {
  if (scan_ && scan.stamp_ns <= scan_->stamp_ns) return;
  scan_ = smoothed(scan, config_.side_margin_m);
  compare_echoes();
}

void GuardInputs::add(const SonarRound& sonar) {
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

void GuardInputs::keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
  drawn_m_ = std::move(points_m);
  if (drawn_m_.empty()) return;
  if (const auto then = odometry_.at(stamp_ns)) {
    T_odom_drawn_ = then->T_odom_robot;
  } else {
    T_odom_drawn_ = last_ ? last_->T_odom_robot : geometry::Pose2{};
  }
}

// Records since when the sonars have no echo although the laser sees something in their reach.
void GuardInputs::watch_silence(const SonarRound& sonar) {
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
void GuardInputs::compare_echoes() {
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

bool GuardInputs::laser_sees(const SonarReading& reading, double up_to_m) const {
  const geometry::Pose2 T_sonar_robot = inverse(reading.T_robot_sonar);
  const double tangent = std::tan(std::min(reading.half_cone_rad, 1.5));  // not used for mapping
  return std::any_of(scan_->points_m.begin(), scan_->points_m.end(), [&](const auto& point_m) {
    const Eigen::Vector2d seen_m = T_sonar_robot * point_m;
    return seen_m.x() > 0.0 && std::fabs(seen_m.y()) <= tangent * seen_m.x() &&
           seen_m.norm() <= up_to_m;
  });
}

bool GuardInputs::fresh(std::int64_t stamp_ns, std::int64_t now_ns) const {
  const double age_s = static_cast<double>(now_ns - stamp_ns) * kNsToSeconds;
  // A measurement from the future belongs to a clock that was set back since.
  return age_s <= config_.oldest_scan_s && age_s >= -kLargestLead_s;
}

HaltReason GuardInputs::health(std::int64_t now_ns, std::string* message) const {
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

bool GuardInputs::has_fresh_sonar(std::int64_t now_ns) const {
  return sonar_ && fresh(sonar_->stamp_ns, now_ns);
}

GuardInputs::Obstacles GuardInputs::obstacles(std::int64_t now_ns) const {
  Obstacles found;
  add_sensed(now_ns, found.points_m);
  found.first_drawn = found.points_m.size();
  add_drawn(found.points_m);
  return found;
}

void GuardInputs::add_sensed(std::int64_t now_ns, std::vector<Eigen::Vector2d>& points_m) const {
  const auto carried = [&](const geometry::Pose2& T_odom_then) {
    return last_ ? between(last_->T_odom_robot, T_odom_then) : geometry::Pose2{};
  };
  const bool scan_counts = scan_ && fresh(scan_->stamp_ns, now_ns);
  if (scan_counts) {
    const geometry::Pose2 T_now_then = carried(scan_->T_odom_robot);
    for (const Eigen::Vector2d& point_m : scan_->points_m) points_m.push_back(T_now_then * point_m);
  }
  if (!has_fresh_sonar(now_ns)) return;
  const geometry::Pose2 T_now_then =
      T_odom_sonar_round_ ? carried(*T_odom_sonar_round_) : geometry::Pose2{};
  for (const Echo& echo : echoes_) {
    if (!scan_counts || !echo.laser_sees) points_m.push_back(T_now_then * echo.point_m);
  }
}

void GuardInputs::add_drawn(std::vector<Eigen::Vector2d>& points_m) const {
  constexpr double kCarried_m = 3.0;  // the distance that a navigator drives without a certain pose
  if (drawn_m_.empty() || !last_) return;
  const geometry::Pose2 T_now_then = between(last_->T_odom_robot, T_odom_drawn_);
  if (T_now_then.position_m().norm() > kCarried_m) return;
  for (const Eigen::Vector2d& point_m : drawn_m_) points_m.push_back(T_now_then * point_m);
}

geometry::Velocity GuardInputs::driven() const {
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
double GuardInputs::age_s(std::int64_t now_ns) const {
  std::int64_t seen_ns = now_ns;
  if (last_) {
    seen_ns = last_->stamp_ns;
  } else if (scan_ || sonar_) {
    seen_ns = scan_ ? scan_->stamp_ns : sonar_->stamp_ns;
  }
  return std::max(0.0, static_cast<double>(now_ns - seen_ns) * kNsToSeconds);
}

}  // namespace topogeo::navigation
