#include "topogeo/devices/power_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace topogeo::devices {
namespace {

/// Time until the base obeys a command: writing, a busy line, motor lag. Not measured on hardware.
/// A slower command that is younger may already be in force.
constexpr std::int64_t kObeys_ns = 300'000'000;
/// Stamps may be too early by this much.
constexpr std::int64_t kEarly_ns = 50'000'000;
/// Guaranteed share of the commanded acceleration.
constexpr double kSure = 0.8;
/// Largest share of the commanded acceleration.
constexpr double kMost = 1.1;
/// Multiple of the acceleration; a motor with power never slows down faster.
constexpr double kDrop = 1.5;
/// Relative tolerance of the commanded speed, besides the ripple.
constexpr double kShare = 0.03;
/// Periods between two reports; more is a gap.
constexpr double kLongestStep = 1.5;
/// Multiple of the standstill speed above which a commanded motion cannot be taken for standstill.
constexpr double kClearly = 3.0;
constexpr double kBarely = 1.2;
/// Uncommanded rest of an axis that was in motion.
constexpr std::int64_t kRest_ns = 100'000'000;
/// The same if it reports acceleration, to a speed hardly above standstill.
constexpr std::int64_t kSlowRest_ns = 300'000'000;

double seconds(std::int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

bool moves(McpPhase phase) {
  return phase == McpPhase::kAccelerate || phase == McpPhase::kConstant;
}

}  // namespace

PowerWatch::PowerWatch(const PowerTolerance& tolerance, std::int64_t period_ns)
    : tolerance_(tolerance),
      longest_step_ns_(std::llround(kLongestStep * static_cast<double>(period_ns))) {}

void PowerWatch::aim_at(double speed, double acceleration, std::int64_t now_ns) {
  if (acceleration != acceleration_) {
    changed_ns_ = now_ns;
    change_written_ = false;
  }
  acceleration_ = acceleration;
  const double direction = speed == 0.0 ? 0.0 : std::copysign(1.0, speed);
  if (direction != direction_) {
    obeyed_ = false;
    rests_since_ns_.reset();
  }
  direction_ = direction;
  if (!aims_.empty() && aims_.back().speed == speed) return;
  aims_.push_back({now_ns, speed, std::nullopt});
  // Drops aims that ended before the oldest time that may be queried.
  constexpr std::int64_t kKept_ns = 2'000'000'000;
  while (aims_.size() > 2 && is_obeyed(aims_[1], now_ns - kKept_ns)) aims_.pop_front();
  // A blocked port must not fill the memory: keeps the first and the latest.
  constexpr std::size_t kMostAims = 1000;
  if (aims_.size() > kMostAims) aims_.erase(aims_.begin() + 1);
}

void PowerWatch::written(std::int64_t now_ns) {
  for (auto aim = aims_.rbegin(); aim != aims_.rend() && !aim->written_ns; ++aim) {
    aim->written_ns = now_ns;
  }
  if (!std::exchange(change_written_, true)) changed_ns_ = now_ns;
}

bool PowerWatch::is_obeyed(const Aim& aim, std::int64_t stamp_ns) {
  return aim.written_ns && *aim.written_ns <= stamp_ns - kObeys_ns;
}

void PowerWatch::forget() {
  before_.reset();
  obeyed_ = false;
  rests_since_ns_.reset();
}

std::size_t PowerWatch::oldest_aim(std::int64_t stamp_ns) const {
  std::size_t oldest = aims_.size();
  while (oldest > 0 && !is_obeyed(aims_[oldest - 1], stamp_ns)) --oldest;
  return oldest == 0 ? 0 : oldest - 1;
}

/// The least speed, in the direction of the motion, of all commands that the base may be obeying at
/// that time. It obeys its commands in order, so commands older than the one obeyed at the previous
/// report no longer count.
double PowerWatch::least_aim(std::int64_t stamp_ns) const {
  std::size_t first = oldest_aim(stamp_ns);
  if (before_ && before_->sound && moves(before_->phase) && before_->commanded_sign == direction_) {
    const double obeyed = direction_ * before_->speed - tolerance_.standstill;
    for (std::size_t i = oldest_aim(before_->stamp_ns);
         i < aims_.size() && aims_[i].since_ns <= before_->stamp_ns + kEarly_ns; ++i) {
      const double aim = direction_ * aims_[i].speed;
      if (aim <= 0.0 || aim < obeyed) continue;
      first = std::max(first, i);
      break;
    }
  }
  double least = direction_ * aims_[first].speed;
  for (std::size_t i = first; i < aims_.size(); ++i) {
    if (aims_[i].since_ns <= stamp_ns + kEarly_ns) {
      least = std::min(least, direction_ * aims_[i].speed);
    }
  }
  return std::max(0.0, least);
}

double PowerWatch::step_s(const AxisReport& report) const {
  return seconds(std::max<std::int64_t>(0, report.base_ns - before_->base_ns));
}

bool PowerWatch::follows_gap(const AxisReport& report) const {
  return before_ && report.base_ns - before_->base_ns > longest_step_ns_;
}

/// The speed grew by more than a motor can: this report or the previous one is garbled.
bool PowerWatch::faster(const AxisReport& report) const {
  const bool may = moves(report.phase) || moves(before_->phase);
  const double gain = may ? kMost * acceleration_ * step_s(report) : 0.0;
  const double sign = std::copysign(1.0, report.speed);
  return std::abs(report.speed) > sign * before_->speed + gain + 2.0 * tolerance_.standstill;
}

/// The speed fell by more than a motor with power can slow down, whatever the command.
bool PowerWatch::dropped(const AxisReport& report) const {
  if (!before_->sound || report.phase == McpPhase::kLimp) return false;
  const double sign = std::copysign(1.0, before_->speed);
  const double lost = std::abs(before_->speed) - std::max(0.0, sign * report.speed);
  return lost > kDrop * acceleration_ * step_s(report) + tolerance_.ramp;
}

/// The least speed, in the direction of the motion, that a motor with power has.
double PowerWatch::due(const AxisReport& report, double least_aim) const {
  const double speed = direction_ * before_->speed;
  // During a gap in the reports commands may have been lost, and an emulated base may have stood
  // still with its machine.
  const double gained_s = follows_gap(report) ? 0.0 : step_s(report);
  double least = speed;
  if (before_->phase == McpPhase::kAccelerate) {
    least = std::max(before_->due, speed) + kSure * acceleration_ * gained_s;
  } else if (before_->phase != McpPhase::kConstant) {
    least = speed - acceleration_ * step_s(report) / kSure;
  }
  return std::clamp(least, 0.0, least_aim);
}

bool PowerWatch::too_slow(const AxisReport& report, double due, double least_aim) const {
  if (report.phase == McpPhase::kLimp) return obeyed_;
  if (report.phase != McpPhase::kAccelerate) return false;
  const bool ramps = before_ && before_->phase == McpPhase::kAccelerate;
  const double tolerance = ramps ? tolerance_.ramp : tolerance_.ripple + kShare * least_aim;
  return due - std::max(0.0, direction_ * report.speed) > tolerance;
}

/// An axis that moved as commanded rests without a command to.
bool PowerWatch::rests(const AxisReport& report, double least_aim) {
  const bool accelerates = report.phase == McpPhase::kAccelerate;
  const double share = accelerates ? kBarely : kClearly;
  const bool stands = std::abs(report.speed) <= tolerance_.standstill &&
                      least_aim > share * tolerance_.standstill &&
                      report.phase != McpPhase::kDecelerate && (accelerates || obeyed_);
  if (!stands) {
    rests_since_ns_.reset();
    return false;
  }
  if (!rests_since_ns_ || rest_phase_ != report.phase || follows_gap(report)) {
    rests_since_ns_ = report.base_ns;
    rest_phase_ = report.phase;
  }
  return report.base_ns - *rests_since_ns_ >= (accelerates ? kSlowRest_ns : kRest_ns);
}

bool PowerWatch::take(const AxisReport& report) {
  const bool garbled = before_ && faster(report);
  if (before_ && before_->suspect && !garbled) return true;
  if (aims_.empty() || !change_written_ || report.stamp_ns < changed_ns_ + kObeys_ns) {
    before_.reset();
    return false;
  }
  const bool others =
      moves(report.phase) && direction_ != 0.0 && report.commanded_sign != direction_ && obeyed_;
  if (others) {  // another controller moves it
    forget();
    return false;
  }
  // A report without a predecessor may be garbled, too.
  const bool sound = before_ && !garbled;
  Before now{report.base_ns, report.stamp_ns,       report.speed, 0.0,
             report.phase,   report.commanded_sign, sound,        false};
  now.suspect = sound && dropped(report);
  bool at_rest = false;
  if (direction_ != 0.0) {
    const double least = least_aim(report.stamp_ns);
    const bool obeys = moves(report.phase) && report.commanded_sign == direction_;
    if (sound && before_->sound) now.due = due(report, least);
    if (obeys && least > 0.0) obeyed_ = true;
    if (obeys || report.phase == McpPhase::kLimp) {
      now.suspect = now.suspect || too_slow(report, now.due, least);
    }
    at_rest = (obeys || !moves(report.phase)) && rests(report, least);
  }
  before_ = now;
  return at_rest;
}

}  // namespace topogeo::devices
