#include "topogeo/devices/base_odometer.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::devices {
namespace {

/// Ticks and clock drift let a message come this much earlier than the least delayed one.
constexpr std::int64_t kEarliest_ns = 25'000'000;
/// After a longer pause of the host, the base counts as restarted.
constexpr std::int64_t kLatest_ns = 3'000'000'000;
constexpr std::int64_t kPause_ns = 1'000'000'000;
/// m/s: the range of 16 bits of encoder counts (2.33 m/s for a B21), and a margin.
constexpr double kFastestSpeed = 2.5;
/// A device's clock is not more wrong than one part in this.
constexpr std::int64_t kDriftDivisor = 1000;
/// Motion of the pose beyond the speeds of two reports: their registers are coarse.
constexpr double kMargin_m = 0.03;
constexpr double kMargin_rad = 0.03;
constexpr std::int64_t kFreshMargin_ns = 1'000'000'000;
/// The same bit may be wrong twice.
constexpr unsigned kFewDoubts = 2;
/// After this many successive reports whose distances do not fit their speeds or whose clocks do
/// not fit the host's, the next one that agrees with them is accepted.
constexpr unsigned kManyDoubts = 4;
/// Relative error of reported speeds.
constexpr double kSpeedDoubt = 0.5;
/// Largest change of speed, as a multiple of the commanded acceleration.
constexpr double kHaste = 2.0;
/// Messages before and after a pause may differ in delay by this much.
constexpr std::int64_t kSameClock_ns = 500'000'000;

}  // namespace

BaseOdometer::BaseOdometer(const BaseSettings& settings)
    : units_(settings.calibration),
      limits_(settings.limits),
      tracker_(units_),
      host_clock_(report_line_time_ns(settings)) {}

/// Without a checksum one wrong digit would move the robot. The distance has to fit the speeds of
/// the two reports or, if `loosely`, the range of a base.
bool BaseOdometer::moved_plausibly(const McpReport& from, const McpReport& to,
                                   std::int64_t elapsed_ns, bool loosely) const {
  McpPoseTracker tracker(units_);
  const geometry::Pose2 T_base_from = tracker.track(from);
  const geometry::Pose2 moved = geometry::between(T_base_from, tracker.track(to));
  const double elapsed_s = 1e-9 * static_cast<double>(elapsed_ns);
  if (loosely || elapsed_ns > kPause_ns) {  // in a pause it may have moved and stopped again
    return moved.position_m().norm() <= kMargin_m + kFastestSpeed * elapsed_s;
  }
  const auto fits = [elapsed_s](double distance, double speed_from, double speed_to,
                                double acceleration, double margin) {
    const double speed = std::max(std::abs(speed_from), std::abs(speed_to));
    const double doubt =
        kSpeedDoubt * speed + std::abs(speed_to - speed_from) / 2 + acceleration * elapsed_s / 4;
    return std::abs(distance - elapsed_s * (speed_from + speed_to) / 2) <=
           margin + doubt * elapsed_s;
  };
  const geometry::Pose2 half_turn{0.0, 0.0, -0.5 * moved.theta_rad};
  const Eigen::Vector2d step_m = half_turn * moved.position_m();
  return fits(step_m.x(), units_.linear_mps(from), units_.linear_mps(to),
              kHaste * limits_.linear_mps2, kMargin_m) &&
         std::abs(step_m.y()) <= kMargin_m &&
         fits(moved.theta_rad, units_.angular_radps(from), units_.angular_radps(to),
              kHaste * limits_.angular_radps2, kMargin_rad);
}

/// The base's clock has advanced since the last report as the host's did.
bool BaseOdometer::clock_follows(const McpReport& report, std::int64_t arrival_ns) const {
  const std::int64_t elapsed_ns = base_clock_.since_last_ns(report.wide(McpField::kClock));
  if (elapsed_ns <= 0) return false;
  const std::int64_t late_ns = host_clock_.lateness_ns(base_ns_ + elapsed_ns, arrival_ns);
  return late_ns >= -kEarliest_ns - elapsed_ns / kDriftDivisor && late_ns <= kLatest_ns;
}

bool BaseOdometer::follows_doubted(const McpReport& report, std::int64_t arrival_ns) const {
  if (!doubted_) return false;
  const auto ticks = static_cast<std::int32_t>(report.wide(McpField::kClock) -
                                               doubted_->report.wide(McpField::kClock));
  const std::int64_t elapsed_ns = ticks_ns(ticks);
  const std::int64_t arrived_ns = arrival_ns - doubted_->arrival_ns;
  return elapsed_ns > 0 && std::abs(elapsed_ns - arrived_ns) < kLatest_ns &&
         moved_plausibly(doubted_->report, report, elapsed_ns, doubts_ >= kManyDoubts);
}

/// The registers of the base have restarted; the robot keeps its pose.
void BaseOdometer::start_from(const McpReport& report) {
  tracker_.restart();
  base_clock_.restart();
  host_clock_.restart();
  T_odom_base_ = T_odom_robot_ * geometry::inverse(tracker_.track(report));
  base_ns_ = base_clock_.follow(report.wide(McpField::kClock));
}

/// The base that sent the last report of an earlier life has not been switched off since.
bool BaseOdometer::counted_on(const McpReport& report, std::int64_t arrival_ns) const {
  const auto ticks = static_cast<std::int32_t>(report.wide(McpField::kClock) -
                                               resumed_->report.wide(McpField::kClock));
  const std::int64_t elapsed_ns = ticks_ns(ticks);
  const std::int64_t arrived_ns = arrival_ns - resumed_->arrival_ns;
  return elapsed_ns > 0 &&
         std::abs(elapsed_ns - arrived_ns) <= kSameClock_ns + arrived_ns / kDriftDivisor &&
         moved_plausibly(resumed_->report, report, elapsed_ns, true);
}

BaseOdometer::Result BaseOdometer::begin(const McpReport& report, std::int64_t arrival_ns) {
  if (resumed_ && counted_on(report, arrival_ns)) {
    T_odom_base_ = resumed_->T_odom_robot * geometry::inverse(tracker_.track(resumed_->report));
    base_clock_.follow(resumed_->report.wide(McpField::kClock));
    has_resumed_ = true;
  } else if (resumed_ && ++doubts_ < kFewDoubts) {
    return {Verdict::kImplausible, {}};  // a wrong digit must not end the odometry
  } else {
    start_from(report);
  }
  resumed_.reset();
  return {Verdict::kGood, accept(report, arrival_ns)};
}

std::optional<OdometerState> BaseOdometer::state() const {
  if (!last_) return std::nullopt;
  return OdometerState{last_->report, last_->arrival_ns, T_odom_robot_};
}

BaseOdometry BaseOdometer::accept(const McpReport& report, std::int64_t arrival_ns) {
  base_ns_ = base_clock_.follow(report.wide(McpField::kClock));
  T_odom_robot_ = T_odom_base_ * tracker_.track(report);
  last_ = Reference{report, arrival_ns};
  doubted_.reset();
  doubts_ = 0;
  return {host_clock_.map(base_ns_, arrival_ns), T_odom_robot_, units_.linear_mps(report),
          units_.angular_radps(report)};
}

BaseOdometer::Result BaseOdometer::take(const McpReport& report, std::int64_t arrival_ns) {
  if (!last_) return begin(report, arrival_ns);
  const bool clock_goes_on = clock_follows(report, arrival_ns);
  const std::int64_t elapsed_ns = base_clock_.since_last_ns(report.wide(McpField::kClock));
  if (clock_goes_on && moved_plausibly(last_->report, report, elapsed_ns, false)) {
    return {Verdict::kGood, accept(report, arrival_ns)};
  }
  if (follows_doubted(report, arrival_ns)) {
    // If the clock goes on, the registers are the same ones: the last report was wrong, or all
    // reports had been late for long.
    const std::int64_t arrived_ns = arrival_ns - last_->arrival_ns;
    const bool same_clock =
        clock_goes_on || (elapsed_ns > 0 && std::abs(elapsed_ns - arrived_ns) < kLatest_ns);
    if (same_clock && doubts_ >= kFewDoubts) {
      return {Verdict::kGood, accept(report, arrival_ns)};
    }
    // A base that was switched on since then has a clock that began then.
    const bool fresh = ticks_ns(report.wide(McpField::kClock)) <= arrived_ns + kFreshMargin_ns;
    if (!same_clock && (fresh || doubts_ >= kManyDoubts)) {
      start_from(doubted_->report);
      return {Verdict::kRestarted, accept(report, arrival_ns)};
    }
  }
  doubted_ = Reference{report, arrival_ns};
  ++doubts_;
  return {Verdict::kImplausible, {}};
}

}  // namespace topogeo::devices
