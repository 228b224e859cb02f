#include "topogeo/devices/motion_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::devices {
namespace {

/// Delay between a command and its effect in a report, apart from the acceleration: writing it,
/// motor lag, transmission of the report. Not measured on hardware; too long a time only delays the
/// detection of the joystick.
constexpr std::int64_t kLag_ns = 300'000'000;
/// A joystick driver pauses for less than this.
constexpr std::int64_t kJoystickRest_ns = 1'000'000'000;
/// A single report may contain a speed that was garbled on the line.
constexpr unsigned kUncommandedReports = 2;

/// Motion up to this multiple of the standstill speed is slow: a base that follows slow commands,
/// each a little faster, reports acceleration and standstill in turn.
constexpr double kSlow = 3.0;

bool stalls(std::uint16_t status, double commanded, double standstill, bool stands) {
  return std::abs(commanded) > kSlow * standstill && stands &&
         phase_of(status) == McpPhase::kAccelerate;
}

/// Phases of a motor that has finished its command, or never started.
bool rests(std::uint16_t status) {
  const McpPhase phase = phase_of(status);
  return phase == McpPhase::kStop || phase == McpPhase::kHalt || phase == McpPhase::kLimp;
}

}  // namespace

void SpeedRange::aim_at(double speed, double acceleration, std::int64_t lag_ns,
                        std::int64_t now_ns) {
  (void)excess(speed, now_ns);
  if (speed == aim_) return;
  aim_ = speed;
  least_ = std::min(least_, speed);
  largest_ = std::max(largest_, speed);
  const double change_s = (largest_ - least_) / acceleration;
  settled_ns_ = std::max(settled_ns_, now_ns + lag_ns + static_cast<std::int64_t>(1e9 * change_s));
}

double SpeedRange::excess(double speed, std::int64_t now_ns) {
  if (settled(now_ns)) {
    least_ = std::min(0.0, aim_);
    largest_ = std::max(0.0, aim_);
  }
  return std::max({0.0, least_ - speed, speed - largest_});
}

MotionMonitor::MotionMonitor(const McpUnits& units, const BaseSettings& settings)
    : units_(units),
      settings_(settings),
      period_ns_(ticks_ns(report_period_ticks(settings))),
      linear_power_({settings.standstill_mps, settings.ripple_mps, settings.ramp_mps}, period_ns_),
      angular_power_({settings.standstill_radps, settings.ripple_radps, settings.ramp_radps},
                     period_ns_) {}

void MotionMonitor::forget_power() {
  linear_power_.forget();
  angular_power_.forget();
  lost_power_ = false;
}

void MotionMonitor::leave_power(const BaseLimits& limits, std::int64_t now_ns) {
  linear_power_.aim_at(0.0, limits.linear_mps2, now_ns);
  angular_power_.aim_at(0.0, limits.angular_radps2, now_ns);
}

void MotionMonitor::watch_power(const McpReport& report, std::int64_t stamp_ns) {
  const std::int64_t base_ns = clock_.follow(report.wide(McpField::kClock));
  const auto axis = [&](McpField status, double speed, double sign) {
    const std::uint16_t word = report.word(status);
    const bool negative = (word & kMcpCommandedNegative) != 0;
    return AxisReport{base_ns, stamp_ns, speed, phase_of(word), negative ? -sign : sign};
  };
  const double forward = units_.counts(1.0) > 0 ? 1.0 : -1.0;
  const double counter_clockwise = units_.rotation_counts(1.0) > 0 ? 1.0 : -1.0;
  const bool linear =
      linear_power_.take(axis(McpField::kTranslateStatus, units_.linear_mps(report), forward));
  const bool angular = angular_power_.take(
      axis(McpField::kRotateStatus, units_.angular_radps(report), counter_clockwise));
  lost_power_ = linear || angular;
}

void MotionMonitor::aim_at(const BaseVelocity& velocity, const BaseLimits& limits,
                           std::int64_t now_ns) {
  if (velocity == BaseVelocity{}) stalls_ = 0;
  const std::int64_t lag_ns = kLag_ns + 2 * period_ns_;
  linear_.aim_at(velocity.linear_mps, limits.linear_mps2, lag_ns, now_ns);
  angular_.aim_at(velocity.angular_radps, limits.angular_radps2, lag_ns, now_ns);
  linear_power_.aim_at(velocity.linear_mps, limits.linear_mps2, now_ns);
  angular_power_.aim_at(velocity.angular_radps, limits.angular_radps2, now_ns);
}

void MotionMonitor::restart(std::int64_t now_ns) {
  const BaseLimits& limits = settings_.limits;
  const std::int64_t lag_ns = kLag_ns + 2 * period_ns_;
  for (const double sign : {1.0, -1.0, 0.0}) {
    linear_.aim_at(sign * limits.linear_mps, limits.linear_mps2, lag_ns, now_ns);
    angular_.aim_at(sign * limits.angular_radps, limits.angular_radps2, lag_ns, now_ns);
  }
  leave_power(limits, now_ns);
  forget_power();
  clock_.restart();
  stalls_ = 0;
  uncommanded_ = 0;
  disobeys_ = false;
  joystick_ = false;
}

void MotionMonitor::take(const McpReport& report, const BaseMotion& motion, std::int64_t stamp_ns,
                         std::int64_t now_ns) {
  watch_power(report, stamp_ns);
  const double linear_mps = units_.linear_mps(report);
  const double angular_radps = units_.angular_radps(report);
  const bool linear_stands = std::abs(linear_mps) <= settings_.standstill_mps;
  const bool angular_stands = std::abs(angular_radps) <= settings_.standstill_radps;
  const std::uint16_t translate = report.word(McpField::kTranslateStatus);
  const std::uint16_t rotate = report.word(McpField::kRotateStatus);

  stands_ = linear_stands && angular_stands;
  reports_standing_ = stands_ ? reports_standing_ + 1 : 0;
  if (!stands_) moved_ns_ = now_ns;
  slows_down_ =
      phase_of(translate) == McpPhase::kDecelerate || phase_of(rotate) == McpPhase::kDecelerate;
  limp_ = phase_of(translate) == McpPhase::kLimp || phase_of(rotate) == McpPhase::kLimp;

  const BaseVelocity& aim = motion.aim();
  const bool stalled = stalls(translate, motion.translates() ? aim.linear_mps : 0.0,
                              settings_.standstill_mps, linear_stands) ||
                       stalls(rotate, motion.rotates() ? aim.angular_radps : 0.0,
                              settings_.standstill_radps, angular_stands);
  stalls_ = stalled ? stalls_ + 1 : 0;

  const bool uncommanded = linear_.excess(linear_mps, now_ns) > settings_.uncommanded_mps ||
                           angular_.excess(angular_radps, now_ns) > settings_.uncommanded_radps;
  uncommanded_ = uncommanded ? uncommanded_ + 1 : 0;
  if (uncommanded_ >= kUncommandedReports) joystick_ = true;
  if (joystick_ && now_ns - moved_ns_ > kJoystickRest_ns) joystick_ = false;
  if (joystick_) forget_power();

  const bool settled = linear_.settled(now_ns) && angular_.settled(now_ns);
  disobeys_ = settled && ((motion.translates() && linear_stands && rests(translate)) ||
                          (motion.rotates() && angular_stands && rests(rotate)));
}

}  // namespace topogeo::devices
