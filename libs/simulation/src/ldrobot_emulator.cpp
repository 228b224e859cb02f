#include "topogeo/simulation/ldrobot_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

using devices::kLdPoints;

/// Period of the error of the motor's control.
constexpr double kWobble_s = 5.0;
/// Change of the motor's speed, turns a second each second.
constexpr double kAcceleration = 5.0;
/// A light surface returns this (LD19 Development Manual).
constexpr std::uint8_t kIntensity = 228;

std::uint16_t hundredths(double angle_deg) {
  return static_cast<std::uint16_t>(std::lround(100.0 * angle_deg) % devices::kLdTurnCdeg);
}

}  // namespace

LdRobotEmulator::LdRobotEmulator(const LdRobotEmulatorSettings& settings, Ranges ranges,
                                 std::int64_t now_ns)
    : TurningEmulator(settings.line, {settings.turns_hz, settings.samples_hz}, settings.range_max_m,
                      settings.seed, std::move(ranges)),
      settings_(settings),
      turns_hz_(settings.turns_hz) {
  if (!(settings.wobble >= 0.0 && settings.wobble < 1.0)) {
    throw std::invalid_argument("an emulated LDROBOT laser needs a wobble of at least 0, below 1");
  }
  schedule(now_ns);
}

void LdRobotEmulator::receive(std::span<const std::uint8_t> /*bytes*/,
                              const devices::LineSettings& /*host*/, std::int64_t now_ns) {
  tick(now_ns);
}

void LdRobotEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  schedule(now_ns + settings_.start_up_ns);
  angle_deg_ = 0.0;
}

void LdRobotEmulator::send_packet() {
  constexpr auto kGaps = static_cast<double>(kLdPoints - 1);
  const double phase_rad =
      geometry::wrap_angle(2.0 * std::numbers::pi / kWobble_s *
                           std::fmod(1e-9 * static_cast<double>(next_ns()), kWobble_s));
  const double change_hz = kAcceleration * static_cast<double>(kLdPoints) / settings_.samples_hz;
  turns_hz_ += std::clamp(settings_.turns_hz - turns_hz_, -change_hz, change_hz);
  const double turns_hz = turns_hz_ * (1.0 + settings_.wobble * geometry::sincos(phase_rad).sin);
  const double step_deg = kTurn_deg * turns_hz / settings_.samples_hz;
  const double end_deg = angle_deg_ + kGaps * step_deg;
  const std::vector<double> readings_mm = measure_mm(angle_deg_, step_deg, kLdPoints);
  devices::LdPacket packet;
  packet.speed_deg_s = static_cast<std::uint16_t>(std::lround(kTurn_deg * turns_hz));
  packet.start_cdeg = hundredths(angle_deg_);
  packet.end_cdeg = hundredths(end_deg);
  packet.time_ms = static_cast<std::uint16_t>(next_ns() / 1'000'000 % devices::kLdTimeWrap_ms);
  for (std::size_t i = 0; i < kLdPoints; ++i) {
    const auto distance_mm = static_cast<std::uint16_t>(readings_mm[i]);
    packet.points[i] = {distance_mm, distance_mm > 0 ? kIntensity : std::uint8_t{0}};
  }
  send(devices::ld_bytes(packet));
  angle_deg_ = end_deg + step_deg;
  if (angle_deg_ >= kTurn_deg) {
    angle_deg_ -= kTurn_deg;
    count_turn();
  }
  schedule(next_ns() + std::llround(1e9 * static_cast<double>(kLdPoints) / settings_.samples_hz));
}

}  // namespace topogeo::simulation
