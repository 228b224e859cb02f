#include "topogeo/simulation/kobuki_emulator.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kKobukiMs_ns = 1'000'000;
constexpr std::int64_t kKobukiPeriod_ns = 20 * kKobukiMs_ns;
constexpr std::int64_t kSlowPeriod_ns = 100 * kKobukiMs_ns;
constexpr std::uint32_t kFastLine = 38'400;
/// On slower lines the emulator leaves out what the driver skips.
constexpr std::uint32_t kFullLine = 57'600;
constexpr double kCdegPerRad = 18'000.0 / std::numbers::pi;
constexpr double kUnitsPerVolt = 10.0;

TwoWheelEmulatorSettings kobuki_wheels(const KobukiEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = settings.wheels.ticks_per_m,
          .track_m = settings.wheels.track_m,
          .report_ns = settings.line.baud < kFastLine ? kSlowPeriod_ns : kKobukiPeriod_ns,
          .seed = settings.seed};
}

/// Speeds of the wheels that the base makes of speed and radius; left and right.
std::array<double, 2> wheels_mps(const devices::KobukiMotion& motion, double track_m) {
  const double speed_mps = 1e-3 * motion.speed_mmps;
  if (motion.radius_mm == 0) return {speed_mps, speed_mps};
  if (motion.radius_mm == 1) return {-speed_mps, speed_mps};
  const double radius_m = 1e-3 * motion.radius_mm;
  const double turn_radps = speed_mps / (radius_m + std::copysign(0.5 * track_m, radius_m));
  return {turn_radps * (radius_m - 0.5 * track_m), turn_radps * (radius_m + 0.5 * track_m)};
}

}  // namespace

KobukiEmulator::KobukiEmulator(const KobukiEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(kobuki_wheels(settings)), kobuki_(settings) {
  switch_on(now_ns);
}

void KobukiEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t /*now_ns*/) {
  reader_.push(bytes);
  while (const auto payload = reader_.next()) {
    const auto motion = devices::kobuki_motion(*payload);
    if (motion) want(wheels_mps(*motion, kobuki_.wheels.track_m));
  }
}

void KobukiEmulator::report(std::int64_t now_ns) {
  seen_.time_ms = static_cast<std::uint16_t>((now_ns - began_ns()) / kKobukiMs_ns);
  for (std::size_t i = 0; i < 2; ++i) seen_.ticks[i] = static_cast<std::uint16_t>(ticks(i));
  seen_.battery_dv = static_cast<std::uint8_t>(std::lround(kUnitsPerVolt * kobuki_.battery_v));
  seen_.heading_cdeg =
      static_cast<std::int16_t>(std::lround(kCdegPerRad * geometry::wrap_angle(heading_rad())));
  std::vector<std::uint8_t> frame = devices::to_bytes(seen_);
  if (kobuki_.line.baud >= kFullLine) {
    // Docking IR, cliff voltages, currents, two samples of the raw gyro, and the inputs.
    std::vector<std::uint8_t> payload(frame.begin() + 3, frame.end() - 1);
    const auto add = [&payload](std::uint8_t id, std::uint8_t size) {
      payload.insert(payload.end(), {id, size});
      payload.insert(payload.end(), size, 0);
    };
    add(3, 3);
    add(5, 6);
    add(6, 2);
    add(13, 14);
    add(16, 16);
    frame = devices::kobuki_frame(payload);
  }
  say_report(std::move(frame), now_ns);
}

void KobukiEmulator::hang_wheels(bool hang) {
  seen_.drops = hang ? 3 : 0;
}

void KobukiEmulator::set_cliff(bool cliff) {
  seen_.cliffs = cliff ? 2 : 0;
}

void KobukiEmulator::set_overcurrent(bool over) {
  seen_.overcurrent = over ? 1 : 0;
}

void KobukiEmulator::set_cable(bool plugged) {
  constexpr std::uint8_t kCharging = 22;
  seen_.charger = plugged ? kCharging : 0;
}

/// The bumpers cover the front. Bits count counter-clockwise from straight ahead, 22.5 degrees
/// each.
void KobukiEmulator::press_bumpers(std::uint16_t pressed, std::int64_t /*now_ns*/) {
  constexpr unsigned kLeft = 0x000E;
  constexpr unsigned kCentre = 0x8001;
  constexpr unsigned kRight = 0x7000;
  seen_.bumpers = static_cast<std::uint8_t>(((pressed & kRight) != 0 ? 1 : 0) |
                                            ((pressed & kCentre) != 0 ? 2 : 0) |
                                            ((pressed & kLeft) != 0 ? 4 : 0));
}

}  // namespace topogeo::simulation
