#include "topogeo/simulation/ldrobot_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/devices/ldrobot_packet.hpp"
#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

using devices::kLdPoints;

constexpr double kTurn_deg = 360.0;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
/// Period of the error of the motor's control.
constexpr double kWobble_s = 5.0;
/// Change of the motor's speed, turns a second each second.
constexpr double kAcceleration = 5.0;
/// A light surface returns this (LD19 Development Manual).
constexpr std::uint8_t kIntensity = 228;
constexpr std::int64_t kNever_ns = std::numeric_limits<std::int64_t>::max();

std::uint16_t millimetres(float range_m, double range_max_m) {
  const auto range = static_cast<double>(range_m);
  if (!std::isfinite(range) || range <= 0.0 || range >= range_max_m) return 0;
  return static_cast<std::uint16_t>(std::lround(1000.0 * range));
}

std::uint16_t hundredths(double angle_deg) {
  return static_cast<std::uint16_t>(std::lround(100.0 * angle_deg) % devices::kLdTurnCdeg);
}

}  // namespace

LdRobotEmulator::LdRobotEmulator(const LdRobotEmulatorSettings& settings, Ranges ranges,
                                 std::int64_t now_ns)
    : settings_(settings),
      ranges_(std::move(ranges)),
      faults_(settings.seed),
      next_ns_(now_ns),
      turns_hz_(settings.turns_hz) {
  if (!(settings.turns_hz > 0.0 && settings.turns_hz <= 30.0) || !(settings.samples_hz > 0.0) ||
      !(settings.wobble >= 0.0 && settings.wobble < 1.0) || settings.line.baud == 0 || !ranges_) {
    throw std::invalid_argument(
        "an emulated LDROBOT laser needs a speed of up to 30 turns a second, samples, a rate of "
        "the "
        "line above 0, and ranges to measure");
  }
}

void LdRobotEmulator::receive(std::span<const std::uint8_t> /*bytes*/,
                              const devices::LineSettings& /*host*/, std::int64_t now_ns) {
  tick(now_ns);
}

void LdRobotEmulator::tick(std::int64_t now_ns) {
  while (now_ns >= next_ns_) send_packet();
}

std::vector<std::uint8_t> LdRobotEmulator::take_output(const devices::LineSettings& host,
                                                       std::int64_t now_ns) {
  return output_.take(host, now_ns);
}

void LdRobotEmulator::switch_off() {
  next_ns_ = kNever_ns;
  output_.clear();
}

void LdRobotEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  next_ns_ = now_ns + settings_.start_up_ns;
  angle_deg_ = 0.0;
}

void LdRobotEmulator::fall_silent(std::int64_t now_ns) {
  tick(now_ns);
  output_.clear();
  silent_ = true;
}

void LdRobotEmulator::speak_again(std::int64_t now_ns) {
  tick(now_ns);
  silent_ = false;
}

void LdRobotEmulator::send_packet() {
  constexpr auto kGaps = static_cast<double>(kLdPoints - 1);
  const double phase_rad =
      geometry::wrap_angle(2.0 * std::numbers::pi / kWobble_s *
                           std::fmod(1e-9 * static_cast<double>(next_ns_), kWobble_s));
  const double change_hz = kAcceleration * static_cast<double>(kLdPoints) / settings_.samples_hz;
  turns_hz_ += std::clamp(settings_.turns_hz - turns_hz_, -change_hz, change_hz);
  const double turns_hz = turns_hz_ * (1.0 + settings_.wobble * geometry::sincos(phase_rad).sin);
  const double step_deg = kTurn_deg * turns_hz / settings_.samples_hz;
  const double end_deg = angle_deg_ + kGaps * step_deg;
  // The last point is the rightmost: angles of the laser frame are counter-clockwise.
  const BeamPattern beams{geometry::wrap_angle(-end_deg * kRadPerDeg), step_deg * kRadPerDeg,
                          kLdPoints, settings_.range_max_m};
  const std::vector<float> ranges_m = ranges_(beams, next_ns_);
  devices::LdPacket packet;
  packet.speed_deg_s = static_cast<std::uint16_t>(std::lround(kTurn_deg * turns_hz));
  packet.start_cdeg = hundredths(angle_deg_);
  packet.end_cdeg = hundredths(end_deg);
  packet.time_ms = static_cast<std::uint16_t>(next_ns_ / 1'000'000 % devices::kLdTimeWrap_ms);
  for (std::size_t i = 0; i < kLdPoints; ++i) {
    const std::uint16_t distance_mm =
        millimetres(ranges_m[kLdPoints - 1 - i], settings_.range_max_m);
    packet.points[i] = {distance_mm, distance_mm > 0 ? kIntensity : std::uint8_t{0}};
  }
  if (!silent_) output_.send(faults_.apply(devices::ld_bytes(packet)), settings_.line, next_ns_);
  angle_deg_ = end_deg + step_deg;
  if (angle_deg_ >= kTurn_deg) {
    angle_deg_ -= kTurn_deg;
    if (!silent_) ++turns_;
  }
  next_ns_ += std::llround(1e9 * static_cast<double>(kLdPoints) / settings_.samples_hz);
}

}  // namespace topogeo::simulation
