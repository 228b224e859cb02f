#include "topogeo/simulation/ldrobot_emulator.hpp"

#include <cmath>
#include <utility>

#include "topogeo/devices/ldrobot_optics.hpp"
#include "topogeo/devices/ldrobot_packet.hpp"

namespace topogeo::simulation {
namespace {

using devices::kLdPoints;

/// A light surface returns this (LD19 Development Manual).
constexpr std::uint8_t kIntensity = 228;

std::uint16_t hundredths(double angle_deg) {
  return static_cast<std::uint16_t>(std::lround(100.0 * angle_deg) % devices::kLdTurnCdeg);
}

double ld08_aside_deg(double distance_mm) {
  return -devices::ld08_point(distance_mm).back_deg;
}

}  // namespace

LdRobotEmulator::LdRobotEmulator(const LdRobotEmulatorSettings& settings, Ranges ranges,
                                 std::int64_t now_ns)
    : TurningEmulator(settings.line, {settings.turns_hz, settings.samples_hz, settings.wobble},
                      settings.range_max_m, settings.seed, std::move(ranges)),
      settings_(settings) {
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
  const double turns_hz = turn_motor(kLdPoints);
  const double step_deg = kTurn_deg * turns_hz / settings_.samples_hz;
  const double end_deg = angle_deg_ + kGaps * step_deg;
  const std::vector<double> readings_mm =
      settings_.beside_axis ? measure_aside_mm(angle_deg_, step_deg, kLdPoints,
                                               {ld08_aside_deg, devices::ld08_distance_mm})
                            : measure_mm(angle_deg_, step_deg, kLdPoints);
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
