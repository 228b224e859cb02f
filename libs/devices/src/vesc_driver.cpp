#include "topogeo/devices/vesc_driver.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::devices {
namespace {

constexpr std::int64_t kVescTimeUnit_ns = 1000;
constexpr double kStepsPerElectricalTurn = 6.0;
constexpr double kVescSecondsPerMinute = 60.0;
/// Electrical turns a minute, more than any motor has.
constexpr double kMostErpm = 1e6;

double electrical_turns_per_m(const VescSettings& vesc) {
  return vesc.pole_pairs * vesc.motor_turns_per_m;
}

WheelUnits vesc_units(const VescSettings& vesc) {
  return {.ticks_per_m = kStepsPerElectricalTurn * electrical_turns_per_m(vesc),
          .track_m = vesc.track_m,
          .time_unit_ns = kVescTimeUnit_ns};
}

void append_bytes(std::vector<std::uint8_t>& bytes, const std::vector<std::uint8_t>& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

}  // namespace

VescDriver::VescDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, vesc_units(settings.vesc)) {}

std::size_t VescDriver::wheel_at_port() const {
  return settings().vesc.port_is_right ? 1 : 0;
}

bool VescDriver::reversed(std::size_t wheel) const {
  return wheel == 0 ? settings().vesc.left_reversed : settings().vesc.right_reversed;
}

std::vector<std::uint8_t> VescDriver::addressed(std::size_t wheel, const VescPacket& packet) const {
  if (wheel == wheel_at_port()) return to_bytes(packet);
  return to_bytes(vesc_forward(static_cast<std::uint8_t>(settings().vesc.can_id), packet));
}

std::vector<std::uint8_t> VescDriver::stop_bytes() const {
  // A controller that waits for the end of a packet that was cut takes the first ones for it.
  std::vector<std::uint8_t> bytes;
  for (int time = 0; time < 2; ++time) {
    for (const std::size_t wheel : {0U, 1U}) append_bytes(bytes, addressed(wheel, vesc_set_rpm(0)));
  }
  return bytes;
}

void VescDriver::poll() {
  answers_ = {};
  std::vector<std::uint8_t> bytes = addressed(0, vesc_get_values());
  append_bytes(bytes, addressed(1, vesc_get_values()));
  write(bytes);
}

void VescDriver::ask(unsigned /*attempt*/, std::int64_t /*now_ns*/) {
  reader_.clear();  // a packet whose end has not come would swallow the next answers
  write(stop_bytes());
  poll();
}

void VescDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  reader_.push(bytes);
  while (const auto packet = reader_.next()) {
    if (const auto values = vesc_values(*packet)) {
      obey(*values, now_ns);
    } else {
      ++bad_fields_;
    }
  }
}

void VescDriver::obey(const VescValues& values, std::int64_t now_ns) {
  const bool at_port = values.controller != settings().vesc.can_id;
  answers_.at(at_port ? wheel_at_port() : 1 - wheel_at_port()) = values;
  if (!answers_[0] || !answers_[1]) return;
  if (!runs()) greet(now_ns);
  constexpr double kVoltsPerUnit = 0.1;
  set_battery(kVoltsPerUnit * std::min(answers_[0]->battery_dv, answers_[1]->battery_dv));
  // The controllers have no clock.
  WheelReport report{.time = static_cast<std::uint32_t>(now_ns / kVescTimeUnit_ns)};
  Signs signs;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto steps = static_cast<std::uint32_t>(answers_[i]->tachometer);
    report.ticks[i] = reversed(i) ? 0U - steps : steps;
    if (answers_[i]->fault != 0) {
      signs.emergency_stop = "the motor controller reports a fault; release it";
    }
  }
  answers_ = {};
  take(report, signs, now_ns);
}

void VescDriver::write_speeds(const BaseVelocity& velocity) {
  const double side_mps = 0.5 * units().track_m * velocity.angular_radps;
  const std::array wheels_mps{velocity.linear_mps - side_mps, velocity.linear_mps + side_mps};
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < 2; ++i) {
    const double erpm =
        kVescSecondsPerMinute * electrical_turns_per_m(settings().vesc) * wheels_mps.at(i);
    const long whole = std::lround(std::clamp(reversed(i) ? -erpm : erpm, -kMostErpm, kMostErpm));
    append_bytes(bytes, addressed(i, vesc_set_rpm(static_cast<std::int32_t>(whole))));
  }
  write(bytes);
  poll();
}

void VescDriver::count_drops(McpDrops& drops) const {
  count_of(drops, McpDrop::kChecksum) = reader_.counters().bad_checksum;
  count_of(drops, McpDrop::kGarbage) = reader_.counters().noise_bytes;
  count_of(drops, McpDrop::kBadReport) = bad_fields_;
}

}  // namespace topogeo::devices
