#include "topogeo/devices/base_odometer.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::devices {
namespace {

constexpr std::int64_t kWindow_ns = 5'000'000'000;
constexpr std::int64_t kSlewDivisor = 50;  // 2 %

/// No message comes earlier than the least delayed one but for ticks and the clocks' drift.
constexpr std::int64_t kEarliest_ns = 25'000'000;
/// A host that was busy for longer than this takes the base for restarted.
constexpr std::int64_t kLatest_ns = 3'000'000'000;
constexpr std::int64_t kPause_ns = 500'000'000;
constexpr double kFastest_mps = 2.5;  // what 16 bits of encoder counts can say, and a little
/// A device's clock is not more wrong than one part in this.
constexpr std::int64_t kDriftDivisor = 1000;
/// The first message may be a late one: after so long the least delay is known.
constexpr std::int64_t kSettled_ns = 2'000'000'000;
/// What the pose may move beyond the speeds of two reports: their registers are coarse.
constexpr double kMargin_m = 0.03;
constexpr double kMargin_rad = 0.03;
constexpr double kSpeedMargin = 1.3;

}  // namespace

std::int64_t DeviceClock::lateness_ns(std::int64_t device_ns, std::int64_t arrival_ns) const {
  if (!started_) return 0;
  const std::int64_t late_ns =
      arrival_ns - transmission_ns_ - device_ns - std::min(least_ns_, before_ns_);
  return last_device_ns_ - first_device_ns_ < kSettled_ns ? std::max<std::int64_t>(late_ns, 0)
                                                          : late_ns;
}

void DeviceClock::settle(std::int64_t device_ns, std::int64_t offset_ns) {
  if (device_ns - window_ns_ > kWindow_ns) {
    // What a pause outlasted says nothing of the clocks now.
    before_ns_ = device_ns - window_ns_ > 2 * kWindow_ns ? offset_ns : least_ns_;
    least_ns_ = offset_ns;
    window_ns_ = device_ns;
  }
  least_ns_ = std::min(least_ns_, offset_ns);
  const std::int64_t most_ns =
      std::max<std::int64_t>(0, device_ns - last_device_ns_) / kSlewDivisor;
  offset_ns_ += std::clamp(std::min(least_ns_, before_ns_) - offset_ns_, -most_ns, most_ns);
}

std::int64_t DeviceClock::map(std::int64_t device_ns, std::int64_t arrival_ns) {
  const std::int64_t offset_ns = arrival_ns - transmission_ns_ - device_ns;
  if (started_) {
    settle(device_ns, offset_ns);
  } else {
    started_ = true;
    first_device_ns_ = window_ns_ = device_ns;
    offset_ns_ = least_ns_ = before_ns_ = offset_ns;
  }
  last_device_ns_ = device_ns;
  const std::int64_t stamp_ns = std::min(device_ns + offset_ns_, arrival_ns);
  const bool first = last_stamp_ns_ == std::numeric_limits<std::int64_t>::min();
  last_stamp_ns_ = first ? stamp_ns : std::max(stamp_ns, last_stamp_ns_ + 1);
  return last_stamp_ns_;
}

BaseOdometer::BaseOdometer(const BaseSettings& settings)
    : units_(settings.calibration), tracker_(units_), host_clock_(report_line_time_ns(settings)) {}

bool BaseOdometer::moved_plausibly(const McpReport& from, const McpReport& to,
                                   std::int64_t elapsed_ns) const {
  McpPoseTracker tracker(units_);
  const geometry::Pose2 T_base_from = tracker.track(from);
  const geometry::Pose2 moved = geometry::between(T_base_from, tracker.track(to));
  const double elapsed_s = 1e-9 * static_cast<double>(elapsed_ns);
  const double linear_mps =
      std::max(std::abs(units_.linear_mps(from)), std::abs(units_.linear_mps(to)));
  const double angular_radps =
      std::max(std::abs(units_.angular_radps(from)), std::abs(units_.angular_radps(to)));
  // In a pause the robot may have moved and stopped again.
  const bool pause = elapsed_ns > kPause_ns;
  const double largest_m =
      kMargin_m + (pause ? kFastest_mps : kSpeedMargin * linear_mps) * elapsed_s;
  const double largest_rad = kMargin_rad + kSpeedMargin * angular_radps * elapsed_s;
  return moved.position_m().norm() <= largest_m &&
         (pause || std::abs(moved.theta_rad) <= largest_rad);
}

bool BaseOdometer::follows(const McpReport& report, std::int64_t arrival_ns) const {
  const std::int64_t elapsed_ns = base_clock_.since_last_ns(report.wide(McpField::kClock));
  if (elapsed_ns <= 0) return false;
  const std::int64_t late_ns = host_clock_.lateness_ns(base_ns_ + elapsed_ns, arrival_ns);
  return late_ns >= -kEarliest_ns - elapsed_ns / kDriftDivisor && late_ns <= kLatest_ns &&
         moved_plausibly(last_->report, report, elapsed_ns);
}

/// The base's registers begin anew; the robot stands where it was.
void BaseOdometer::start_from(const McpReport& report) {
  tracker_.restart();
  base_clock_.restart();
  host_clock_.restart();
  T_odom_base_ = T_odom_robot_ * geometry::inverse(tracker_.track(report));
  base_ns_ = base_clock_.follow(report.wide(McpField::kClock));
}

BaseOdometry BaseOdometer::accept(const McpReport& report, std::int64_t arrival_ns) {
  base_ns_ = base_clock_.follow(report.wide(McpField::kClock));
  T_odom_robot_ = T_odom_base_ * tracker_.track(report);
  last_ = Reference{report, arrival_ns};
  doubted_.reset();
  return {host_clock_.map(base_ns_, arrival_ns), T_odom_robot_, units_.linear_mps(report),
          units_.angular_radps(report)};
}

BaseOdometer::Result BaseOdometer::take(const McpReport& report, std::int64_t arrival_ns) {
  if (!last_) {
    start_from(report);
    return {Verdict::kGood, accept(report, arrival_ns)};
  }
  if (follows(report, arrival_ns)) return {Verdict::kGood, accept(report, arrival_ns)};
  if (doubted_) {
    const auto ticks = static_cast<std::int32_t>(report.wide(McpField::kClock) -
                                                 doubted_->report.wide(McpField::kClock));
    const std::int64_t elapsed_ns = ticks_ns(ticks);
    const std::int64_t arrived_ns = arrival_ns - doubted_->arrival_ns;
    if (elapsed_ns > 0 && std::abs(elapsed_ns - arrived_ns) < kLatest_ns &&
        moved_plausibly(doubted_->report, report, elapsed_ns)) {
      start_from(doubted_->report);
      return {Verdict::kRestarted, accept(report, arrival_ns)};
    }
  }
  doubted_ = Reference{report, arrival_ns};
  return {Verdict::kImplausible, {}};
}

}  // namespace topogeo::devices
