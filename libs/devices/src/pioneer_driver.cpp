#include "topogeo/devices/pioneer_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kPioneerMs_ns = 1'000'000;
constexpr std::int64_t kPioneerPeriod_ns = 100 * kPioneerMs_ns;
constexpr std::int64_t kAskMotorsAgain_ns = 500 * kPioneerMs_ns;
constexpr std::int64_t kPioneerTimeUnit_ns = 1000;
constexpr std::uint8_t kLastSync = 2;
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// The server reports a pose. Its motion becomes that of two wheels, whose distance only has to be
/// the same in both directions, counted finely.
constexpr WheelUnits kPioneerWheels{
    .ticks_per_m = 100'000.0, .track_m = 0.33, .time_unit_ns = kPioneerTimeUnit_ns};

/// The argument of a command for this value.
int pioneer_argument(double value) {
  constexpr double kMost = std::numeric_limits<std::int16_t>::max();
  return static_cast<int>(std::lround(std::clamp(value, -kMost, kMost)));
}

/// Difference of two coordinates that wrap.
int difference_of(std::uint16_t from, std::uint16_t to) {
  constexpr int kWrap = 1 << kPioneerPositionBits;
  const int ahead = (to - from) & (kWrap - 1);
  return ahead < kWrap / 2 ? ahead : ahead - kWrap;
}

}  // namespace

PioneerDriver::PioneerDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, kPioneerWheels),
      times_(kPioneerPeriod_ns),
      sonars_(settings.pioneer.sonar_units_per_m) {}

void PioneerDriver::order(std::uint8_t command, std::optional<int> value) {
  write(to_bytes(PioneerOrder{command, value}));
}

std::vector<std::uint8_t> PioneerDriver::stop_bytes() const {
  // A server that waits for the end of a packet that was cut takes the first one for it.
  std::vector<std::uint8_t> bytes;
  for (const std::uint8_t command : {pioneer_command::kSpeed, pioneer_command::kTurn,
                                     pioneer_command::kSpeed, pioneer_command::kTurn}) {
    const std::vector<std::uint8_t> stop = to_bytes(PioneerOrder{command, 0});
    bytes.insert(bytes.end(), stop.begin(), stop.end());
  }
  return bytes;
}

/// A server whose last program was killed still reports, and may move. Closing it would forget
/// where it is, so it comes later; it also ends a connection whose opening was lost.
void PioneerDriver::ask(unsigned attempt, std::int64_t /*now_ns*/) {
  write(stop_bytes());
  reader_.clear();  // a packet whose end has not come would swallow the next answers
  expected_sync_ = 0;
  if (attempt == 0) return;
  order(attempt % 2 == 1 ? pioneer_command::kPulse : pioneer_command::kClose);
}

void PioneerDriver::synchronize(std::uint8_t answered) {
  if (runs() || answered != expected_sync_) return;
  ++expected_sync_;
  if (answered < kLastSync) return order(expected_sync_);
  last_.reset();
  was_enabled_ = false;  // a server that was just connected has its motors off
  order(pioneer_command::kOpen);
  write(stop_bytes());
}

void PioneerDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  reader_.push(bytes);
  std::vector<PioneerReport> reports;
  while (const auto packet = reader_.next()) {
    constexpr std::uint8_t kFirstType = 0x30;
    if (packet->payload[0] <= kLastSync) {
      synchronize(packet->payload[0]);
    } else if (auto report = pioneer_report(*packet)) {
      reports.push_back(*std::move(report));
    } else if (packet->payload[0] / 16 == kFirstType / 16) {
      ++bad_fields_;
    }
  }
  for (std::size_t i = 0; i < reports.size(); ++i) {
    obey(reports[i], times_.next(reports.size() - 1 - i, now_ns), now_ns);
  }
}

PioneerDriver::Signs PioneerDriver::signs_of(const PioneerReport& report) const {
  Signs signs{.bumpers = pioneer_bumpers(report)};
  const bool stalls = (report.stalls & (kPioneerLeftStall | kPioneerRightStall)) != 0;
  if ((report.flags & kPioneerStopped) != 0) {
    signs.emergency_stop = "";
  } else if (was_enabled_ && !enabled_) {
    signs.emergency_stop = "the motors were switched off; release them";
  } else if (stalls && signs.bumpers == 0) {
    signs.emergency_stop = "a wheel is blocked: free it and release it";
  }
  return signs;
}

void PioneerDriver::obey(const PioneerReport& report, std::int64_t time_ns, std::int64_t now_ns) {
  if (!runs()) greet(now_ns);
  enabled_ = (report.flags & kPioneerMotors) != 0;
  constexpr double kVoltsPerUnit = 0.1;
  set_battery(kVoltsPerUnit * report.battery_dv);
  sonars_.take(report.echoes, now_ns);
  const Signs signs = signs_of(report);
  was_enabled_ = (was_enabled_ || enabled_) && !signs.emergency_stop;
  move(report);
  WheelReport wheels{.time = static_cast<std::uint32_t>(time_ns / kPioneerTimeUnit_ns)};
  for (std::size_t i = 0; i < 2; ++i) {
    wheels.ticks[i] =
        static_cast<std::uint32_t>(std::llround(wheels_m_[i] * kPioneerWheels.ticks_per_m));
  }
  take(wheels, signs, now_ns);
  want_motors(now_ns);
  write_next_limit();
}

void PioneerDriver::move(const PioneerReport& report) {
  const double unit_rad = 2.0 * std::numbers::pi / settings().pioneer.units_per_turn;
  const Place place{report.x, report.y, unit_rad * report.heading};
  const auto before = std::exchange(last_, place);
  if (!before) return;
  const double turn_rad = geometry::wrap_angle(place.heading_rad - before->heading_rad);
  const geometry::SinCos direction = geometry::sincos(before->heading_rad + 0.5 * turn_rad);
  const double forward_m = (difference_of(before->x, place.x) * direction.cos +
                            difference_of(before->y, place.y) * direction.sin) /
                           settings().pioneer.units_per_m;
  const double side_m = 0.5 * kPioneerWheels.track_m * turn_rad;
  wheels_m_[0] += forward_m - side_m;
  wheels_m_[1] += forward_m + side_m;
}

void PioneerDriver::want_motors(std::int64_t now_ns) {
  if (enabled_ || stopped() || now_ns < asked_motors_ns_ + kAskMotorsAgain_ns) return;
  asked_motors_ns_ = now_ns;
  write(stop_bytes());
  order(pioneer_command::kEnable, 1);
}

void PioneerDriver::released(std::int64_t now_ns) {
  asked_motors_ns_ = now_ns - kAskMotorsAgain_ns;
}

std::string_view PioneerDriver::hindrance() const {
  return enabled_ ? "" : "the motors do not switch on";
}

void PioneerDriver::write_next_limit() {
  const BaseLimits& most = settings().limits;
  const int speed = pioneer_argument(1e3 * most.linear_mps2);
  const int turn = pioneer_argument(kDegrees * most.angular_radps2);
  const std::array<PioneerOrder, 7> limits{
      {{pioneer_command::kSetAcceleration, -speed},
       {pioneer_command::kSetTurnAcceleration, -turn},
       {pioneer_command::kSetAcceleration, speed},
       {pioneer_command::kSetTurnAcceleration, turn},
       {pioneer_command::kSetFastest, pioneer_argument(1e3 * most.linear_mps)},
       {pioneer_command::kSetFastestTurn,
        pioneer_argument(std::ceil(kDegrees * most.angular_radps))},
       {pioneer_command::kSonar, settings().pioneer.sonars ? 1 : 0}}};
  write(to_bytes(limits[next_limit_]));
  next_limit_ = (next_limit_ + 1) % limits.size();
}

void PioneerDriver::write_speeds(const BaseVelocity& velocity) {
  order(pioneer_command::kSpeed, pioneer_argument(1e3 * velocity.linear_mps));
  order(pioneer_command::kTurn, pioneer_argument(kDegrees * velocity.angular_radps));
}

void PioneerDriver::count_drops(McpDrops& drops) const {
  count_of(drops, McpDrop::kChecksum) = reader_.counters().bad_checksum;
  count_of(drops, McpDrop::kGarbage) = reader_.counters().noise_bytes;
  count_of(drops, McpDrop::kBadReport) = bad_fields_;
}

}  // namespace topogeo::devices
