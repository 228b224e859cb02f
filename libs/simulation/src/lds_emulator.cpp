#include "topogeo/simulation/lds_emulator.hpp"

#include <cmath>
#include <utility>

namespace topogeo::simulation {
namespace {

constexpr std::uint16_t kLdsIntensity = 200;
constexpr double kSecondsPerMinute = 60.0;

double readings_hz(const LdsEmulatorSettings& settings) {
  return settings.turns_hz * static_cast<double>(settings.format.packets) *
         static_cast<double>(settings.format.readings);
}

}  // namespace

LdsEmulator::LdsEmulator(const LdsEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns)
    : TurningEmulator(
          settings.line,
          {settings.turns_hz, readings_hz(settings), settings.wobble, settings.format.clockwise},
          settings.range_max_m, settings.seed, std::move(ranges)),
      settings_(settings) {
  if (!settings.waits_for_letter) schedule(now_ns);
}

void LdsEmulator::receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
                          std::int64_t now_ns) {
  tick(now_ns);
  if (!settings_.waits_for_letter || off_ || is_silent() || host != settings_.line) return;
  for (const std::uint8_t byte : bytes) {
    if (byte == 'b' && !turns()) schedule(now_ns + settings_.start_up_ns);
    if (byte == 'e') schedule(kNever_ns);
  }
}

void LdsEmulator::switch_off() {
  TurningEmulator::switch_off();
  off_ = true;
}

void LdsEmulator::switch_on(std::int64_t now_ns) {
  TurningEmulator::switch_off();
  off_ = false;
  number_ = 0;
  if (!settings_.waits_for_letter) schedule(now_ns + settings_.start_up_ns);
}

void LdsEmulator::send_packet() {
  const devices::LdsFormat& format = settings_.format;
  const double turns_hz = turn_motor(format.readings);
  const auto first_deg = static_cast<double>(number_ * format.readings);
  devices::LdsPacket packet;
  packet.number = number_;
  packet.speed =
      static_cast<std::uint16_t>(std::lround(turns_hz * kSecondsPerMinute / format.rpm_per_unit));
  for (const double reading_mm : measure_mm(first_deg, 1.0, format.readings)) {
    const auto distance_mm = static_cast<std::uint16_t>(reading_mm);
    packet.readings.push_back({distance_mm, distance_mm > 0 ? kLdsIntensity : std::uint16_t{0}});
  }
  std::vector<std::uint8_t> bytes = devices::lds_bytes(packet, format);
  if (settings_.wrong_checksums) bytes.back() ^= 0x55U;
  send(std::move(bytes));
  number_ = (number_ + 1) % format.packets;
  if (number_ == 0) count_turn();
  schedule(next_ns() + std::llround(1e9 / (turns_hz * static_cast<double>(format.packets))));
}

}  // namespace topogeo::simulation
