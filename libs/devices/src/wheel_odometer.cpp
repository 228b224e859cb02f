#include "topogeo/devices/wheel_odometer.hpp"

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kWheelMs_ns = 1'000'000;
constexpr unsigned kCountBits = 32;
/// A report of a base that works follows the last one within this time.
constexpr std::int64_t kLongestGap_ns = 1000 * kWheelMs_ns;
/// After a silence, the base's time has passed as the host's, but for delays of the line and one
/// part in so many.
constexpr std::int64_t kSilenceError_ns = 200 * kWheelMs_ns;
constexpr std::int64_t kClockDivisor = 50;
/// A wheel turns faster than it may by this share at most, plus what a push adds.
constexpr double kFaster = 3.0;
constexpr double kPush_m = 0.1;

void require_unit(const char* name, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw std::invalid_argument(std::string("base setting ") + name + " is " + std::to_string(value) +
                              ", expected " + std::to_string(least) + " to " +
                              std::to_string(most));
}

}  // namespace

WheelOdometer::WheelOdometer(const WheelUnits& units, const BaseLimits& most)
    : units_(units),
      fastest_mps_(kFaster * (most.linear_mps + 0.5 * units.track_m * most.angular_radps)) {
  constexpr double kMostTicks = 1e7;
  constexpr double kShortestTrack_m = 0.01;
  constexpr double kLongestTrack_m = 10.0;
  require_unit("ticks_per_m", units.ticks_per_m, 1.0, kMostTicks);
  require_unit("track_m", units.track_m, kShortestTrack_m, kLongestTrack_m);
}

void WheelOdometer::silent() {
  silent_ = true;
  doubted_.reset();
}

std::int64_t WheelOdometer::gap_ns(const Arrival& arrival) const {
  return arrival.now_ns - last_->now_ns;
}

std::int64_t WheelOdometer::passed_ns(const Arrival& arrival) const {
  const std::int64_t wrap = std::int64_t{1} << units_.time_bits;
  const std::int64_t wrap_ns = wrap * units_.time_unit_ns;
  const std::int64_t passed = (std::int64_t{arrival.report.time} - last_->report.time) & (wrap - 1);
  const std::int64_t passed_ns = passed * units_.time_unit_ns;
  const std::int64_t missing_ns = gap_ns(arrival) - passed_ns;
  if (missing_ns <= 0) return passed_ns;
  return passed_ns + (missing_ns + wrap_ns / 2) / wrap_ns * wrap_ns;
}

double WheelOdometer::moved_m(const Arrival& arrival, std::size_t wheel) const {
  const unsigned unused = kCountBits - units_.tick_bits;
  const std::uint32_t moved = arrival.report.ticks[wheel] - last_->report.ticks[wheel];
  return (static_cast<std::int32_t>(moved << unused) >> unused) / units_.ticks_per_m;
}

bool WheelOdometer::follows(const Arrival& arrival) const {
  const std::array<std::uint32_t, 2> zero{};
  if (silent_ && arrival.report.ticks == zero && last_->report.ticks != zero) return false;
  const std::int64_t passed = passed_ns(arrival);
  const std::int64_t gap = gap_ns(arrival);
  if (passed == 0 || passed > kLongestGap_ns + gap) return false;
  const bool time_wraps_soon = units_.time_bits < kCountBits;
  if (silent_ && time_wraps_soon &&
      std::abs(passed - gap) > kSilenceError_ns + gap / kClockDivisor) {
    return false;
  }
  const double most_m = kPush_m + 1e-9 * static_cast<double>(passed) * fastest_mps_;
  return std::fabs(moved_m(arrival, 0)) <= most_m && std::fabs(moved_m(arrival, 1)) <= most_m;
}

WheelOdometer::Verdict WheelOdometer::take(const WheelReport& report, std::int64_t now_ns) {
  const Arrival arrival{report, now_ns};
  Verdict verdict = last_ ? Verdict::kMoved : Verdict::kFirst;
  if (last_ && !follows(arrival)) {
    const auto before = std::exchange(last_, std::exchange(doubted_, arrival));
    if (!last_ || !follows(arrival)) {
      last_ = before;
      return Verdict::kDoubted;
    }
    verdict = Verdict::kRestarted;
    clock_.restart();
  }
  doubted_.reset();
  silent_ = false;
  if (last_) move(arrival);
  last_ = arrival;
  return verdict;
}

void WheelOdometer::move(const Arrival& arrival) {
  const std::int64_t passed = passed_ns(arrival);
  const double passed_s = 1e-9 * static_cast<double>(passed);
  const double left_m = moved_m(arrival, 0);
  const double right_m = moved_m(arrival, 1);
  rests_ = left_m == 0.0 && right_m == 0.0;
  const double forward_m = 0.5 * (left_m + right_m);
  double turn_rad = (right_m - left_m) / units_.track_m;
  const WheelReport& report = arrival.report;
  if (report.turn_radps) turn_rad = *report.turn_radps * passed_s;
  if (report.heading_rad && last_->report.heading_rad) {
    turn_rad = geometry::wrap_angle(*report.heading_rad - *last_->report.heading_rad);
  }
  // Half the turn, forward, the other half.
  const geometry::Pose2 half{0.0, 0.0, 0.5 * turn_rad};
  odometry_.T_odom_robot =
      odometry_.T_odom_robot * half * geometry::Pose2{forward_m, 0.0, 0.0} * half;
  device_ns_ += passed;
  odometry_.stamp_ns = clock_.map(device_ns_, arrival.now_ns);
  odometry_.linear_mps = forward_m / passed_s;
  odometry_.angular_radps = turn_rad / passed_s;
}

}  // namespace topogeo::devices
