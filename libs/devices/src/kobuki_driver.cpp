#include "topogeo/devices/kobuki_driver.hpp"

#include <numbers>

namespace topogeo::devices {
namespace {

constexpr unsigned kKobukiCountBits = 16;
constexpr double kRadPerCdeg = std::numbers::pi / 18'000.0;
constexpr double kVoltsPerUnit = 0.1;

WheelUnits kobuki_units(const KobukiSettings& kobuki) {
  return {.ticks_per_m = kobuki.ticks_per_m,
          .track_m = kobuki.track_m,
          .tick_bits = kKobukiCountBits,
          .time_bits = kKobukiCountBits};
}

}  // namespace

KobukiDriver::KobukiDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, kobuki_units(settings.kobuki)) {}

std::vector<std::uint8_t> KobukiDriver::stop_bytes() const {
  // A frame that was cut takes the first one for its end.
  std::vector<std::uint8_t> twice = to_bytes(KobukiMotion());
  const std::vector<std::uint8_t> once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  return twice;
}

/// It reports by itself. If it is not heard, it may hear.
void KobukiDriver::ask(unsigned /*attempt*/, std::int64_t /*now_ns*/) {
  write(stop_bytes());
}

void KobukiDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  while (const auto report = decoder_.next()) obey(*report, now_ns);
}

void KobukiDriver::obey(const KobukiReport& report, std::int64_t now_ns) {
  if (!runs()) greet(now_ns);
  cable_ = (report.charger & kKobukiCable) != 0;
  set_battery(kVoltsPerUnit * report.battery_dv);
  Signs signs{.bumpers = report.bumpers};
  if (report.drops != 0) {
    signs.emergency_stop = kWheelHangs;
  } else if (report.cliffs != 0) {
    signs.emergency_stop = kNoFloor;
  } else if (report.overcurrent != 0) {
    signs.emergency_stop = "the motor of a wheel takes too much current: free it and release it";
  }
  WheelReport wheels{.time = report.time_ms, .ticks = {report.ticks[0], report.ticks[1]}};
  if (settings().kobuki.gyro && report.heading_cdeg) {
    wheels.heading_rad = kRadPerCdeg * *report.heading_cdeg;
  }
  take(wheels, signs, now_ns);
}

std::string_view KobukiDriver::hindrance() const {
  return cable_ ? "the cable of the charger is plugged in" : "";
}

void KobukiDriver::write_speeds(const BaseVelocity& velocity) {
  write(to_bytes(kobuki_motion(velocity.linear_mps, velocity.angular_radps, units().track_m)));
}

void KobukiDriver::count_drops(McpDrops& drops) const {
  const KobukiCounters counters = decoder_.counters();
  count_of(drops, McpDrop::kChecksum) = counters.bad_checksum;
  count_of(drops, McpDrop::kGarbage) = counters.noise_bytes;
  count_of(drops, McpDrop::kBadReport) = counters.bad_fields;
}

}  // namespace topogeo::devices
