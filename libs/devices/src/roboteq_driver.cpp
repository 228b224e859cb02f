#include "topogeo/devices/roboteq_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace topogeo::devices {
namespace {

constexpr std::int64_t kRoboteqTimeUnit_ns = 1000;
/// The flags are asked twice each time: changed ones count after two polls.
constexpr unsigned kSureFlags = 4;
constexpr unsigned kPollsPerVoltage = 16;

WheelUnits roboteq_units(const RoboteqSettings& roboteq) {
  return {.ticks_per_m = roboteq.ticks_per_m,
          .track_m = roboteq.track_m,
          .time_unit_ns = kRoboteqTimeUnit_ns};
}

}  // namespace

RoboteqDriver::RoboteqDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, roboteq_units(settings.roboteq)) {}

void RoboteqDriver::write_text(const std::string& text) {
  write({text.begin(), text.end()});
}

std::array<std::size_t, 2> RoboteqDriver::channels() const {
  const std::size_t left = settings().roboteq.left_channel - 1U;
  return {left, 1U - left};
}

/// The empty line ends one that was cut. The controller is there when it shows its new watchdog.
void RoboteqDriver::ask(unsigned /*attempt*/, std::int64_t /*now_ns*/) {
  same_flags_ = 0;
  flags_ = 0;
  write_text("\r" + speed_lines({0.0, 0.0}) + roboteq_line({'^', "ECHOF", {1}}) + watchdog_line() +
             roboteq_line({'~', "RWD"}));
}

std::int32_t RoboteqDriver::watchdog_ms() const {
  return static_cast<std::int32_t>(std::lround(1e3 * settings().watchdog_s));
}

std::string RoboteqDriver::watchdog_line() const {
  return roboteq_line({'^', "RWD", {watchdog_ms()}});
}

std::string RoboteqDriver::speed_lines(const std::array<double, 2>& wheels_mps) const {
  const RoboteqSettings& roboteq = settings().roboteq;
  constexpr double kRoboteqSecondsPerMinute = 60.0;
  constexpr double kFullCommand = 1000.0;
  std::string lines;
  for (std::size_t i = 0; i < 2; ++i) {
    const bool reversed = i == 0 ? roboteq.left_reversed : roboteq.right_reversed;
    const double rpm = (reversed ? -kRoboteqSecondsPerMinute : kRoboteqSecondsPerMinute) *
                       roboteq.motor_turns_per_m * wheels_mps[i];
    const bool share = roboteq.full_rpm > 0.0;
    const double most = share ? kFullCommand : std::numeric_limits<std::int16_t>::max();
    const double value = share ? kFullCommand * rpm / roboteq.full_rpm : rpm;
    lines +=
        roboteq_line({'!',
                      share ? "G" : "S",
                      {static_cast<std::int32_t>(channels()[i] + 1U),
                       static_cast<std::int32_t>(std::lround(std::clamp(value, -most, most)))}});
  }
  return lines;
}

void RoboteqDriver::write_speeds(const BaseVelocity& velocity) {
  const double side_mps = 0.5 * units().track_m * velocity.angular_radps;
  std::string text = speed_lines({velocity.linear_mps - side_mps, velocity.linear_mps + side_mps});
  for (const char* const query : {"C", "FF", "FF", "C"}) text += roboteq_line({'?', query});
  // A controller that restarted in a moment has its stored watchdog again.
  if (polls_++ % kPollsPerVoltage == 0) text += roboteq_line({'?', "V"}) + watchdog_line();
  write_text(text);
}

void RoboteqDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  while (const auto answer = decoder_.next()) obey(*answer, now_ns);
  if (!counts_) return;
  // The controller has no clock. Two reports of one reading of the port would have the same time.
  const auto time = static_cast<std::uint32_t>(now_ns / kRoboteqTimeUnit_ns);
  take({.time = time, .ticks = *counts_}, signs(), now_ns);
  counts_.reset();
}

void RoboteqDriver::obey(const RoboteqAnswer& answer, std::int64_t now_ns) {
  const std::vector<std::int32_t>& numbers = answer.numbers;
  if (answer.name == "RWD") {
    if (!runs() && numbers.front() == watchdog_ms()) {
      polls_ = 0;
      greet(now_ns);
    }
  } else if (answer.name == "C" && numbers.size() == 2) {
    const RoboteqSettings& roboteq = settings().roboteq;
    const auto left = static_cast<std::uint32_t>(numbers[channels()[0]]);
    const auto right = static_cast<std::uint32_t>(numbers[channels()[1]]);
    take_counts(
        {roboteq.left_reversed ? 0U - left : left, roboteq.right_reversed ? 0U - right : right});
  } else if (answer.name == "FF" && numbers.size() == 1) {
    take_flags(numbers.front());
  } else if (answer.name == "V" && numbers.size() == 3) {
    constexpr double kVoltsPerUnit = 0.1;
    set_battery(kVoltsPerUnit * numbers[1]);
  } else {
    ++bad_fields_;
  }
}

void RoboteqDriver::take_counts(const std::array<std::uint32_t, 2>& counts) {
  constexpr double kAgree_m = 0.01;
  const auto agree = [&](std::size_t wheel) {
    const auto step = static_cast<std::int32_t>(counts[wheel] - (*last_counts_)[wheel]);
    return std::fabs(step / units().ticks_per_m) <= kAgree_m;
  };
  if (last_counts_ && agree(0) && agree(1)) counts_ = counts;
  last_counts_ = counts;
}

void RoboteqDriver::take_flags(std::int32_t flags) {
  same_flags_ = flags == last_flags_ ? same_flags_ + 1 : 1;
  last_flags_ = flags;
  if (same_flags_ >= kSureFlags) flags_ = flags;
}

RoboteqDriver::Signs RoboteqDriver::signs() const {
  Signs signs;
  if ((flags_ & kRoboteqEmergencyStop) != 0) {
    signs.emergency_stop = "";
  } else if ((flags_ & kRoboteqFaults) != 0) {
    signs.emergency_stop = "the motor controller reports a fault; release it";
  }
  return signs;
}

void RoboteqDriver::released(std::int64_t /*now_ns*/) {
  flags_ = 0;  // until they come again
  same_flags_ = 0;
  if (runs()) write_text(roboteq_line({'!', "MG"}));
}

void RoboteqDriver::count_drops(McpDrops& drops) const {
  count_of(drops, McpDrop::kUnknownLine) = decoder_.counters().bad_lines;
  count_of(drops, McpDrop::kLongLine) = decoder_.counters().long_lines;
  count_of(drops, McpDrop::kBadReport) = bad_fields_;
}

}  // namespace topogeo::devices
