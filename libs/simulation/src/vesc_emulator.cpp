#include "topogeo/simulation/vesc_emulator.hpp"

#include <algorithm>
#include <cmath>

namespace topogeo::simulation {
namespace {

constexpr std::uint8_t kNumberAtPort = 1;
constexpr double kEmulatedStepsPerTurn = 6.0;

double emulated_turns_per_m(const devices::VescSettings& wheels) {
  return wheels.pole_pairs * wheels.motor_turns_per_m;
}

TwoWheelEmulatorSettings vesc_wheels(const VescEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = kEmulatedStepsPerTurn * emulated_turns_per_m(settings.wheels),
          .track_m = settings.wheels.track_m,
          .seed = settings.seed};
}

}  // namespace

VescEmulator::VescEmulator(const VescEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(vesc_wheels(settings)), vesc_(settings) {
  switch_on(now_ns);
}

void VescEmulator::forget() {
  reader_.clear();
  erpm_ = {};
}

void VescEmulator::stand_still(std::int64_t duration_ns) {
  for (std::int64_t& commanded_ns : commanded_ns_) commanded_ns += duration_ns;
  TwoWheelEmulator::stand_still(duration_ns);
}

int VescEmulator::direction(std::size_t wheel) const {
  return (wheel == 0 ? vesc_.wheels.left_reversed : vesc_.wheels.right_reversed) ? -1 : 1;
}

void VescEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  reader_.push(bytes);
  while (const auto packet = reader_.next()) {
    if (packet->payload[0] != devices::vesc_command::kForward) {
      obey_packet(wheel_at_port(), *packet, now_ns);
    } else if (packet->payload.size() > 2 && packet->payload[1] == vesc_.wheels.can_id &&
               !can_cut_) {
      const devices::VescPacket inner{{packet->payload.begin() + 2, packet->payload.end()}};
      obey_packet(1 - wheel_at_port(), inner, now_ns);
    }
  }
}

void VescEmulator::obey_packet(std::size_t wheel, const devices::VescPacket& packet,
                               std::int64_t now_ns) {
  if (packet == devices::vesc_get_values()) return answer(wheel, now_ns);
  const auto erpm = devices::vesc_rpm(packet);
  if (!erpm) return;
  erpm_.at(wheel) = *erpm;
  commanded_ns_.at(wheel) = now_ns;
  drive();
}

void VescEmulator::answer(std::size_t wheel, std::int64_t now_ns) {
  constexpr double kUnitsPerVolt = 10.0;
  const bool at_port = wheel == wheel_at_port();
  const devices::VescValues values{
      .battery_dv = static_cast<std::int16_t>(std::lround(kUnitsPerVolt * vesc_.battery_v)),
      .tachometer = static_cast<std::int32_t>(direction(wheel) * ticks(wheel)),
      .fault = fault_,
      .controller = at_port ? kNumberAtPort : static_cast<std::uint8_t>(vesc_.wheels.can_id)};
  say_report(devices::to_bytes(devices::to_packet(values)), now_ns);
}

void VescEmulator::drive() {
  constexpr double kVescSecondsPerMinute = 60.0;
  std::array<double, 2> wheels_mps{};
  for (std::size_t i = 0; i < 2; ++i) {
    wheels_mps.at(i) =
        direction(i) * erpm_.at(i) / kVescSecondsPerMinute / emulated_turns_per_m(vesc_.wheels);
  }
  want(wheels_mps);
}

void VescEmulator::tick(std::int64_t now_ns) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (erpm_.at(i) == 0 || now_ns < commanded_ns_.at(i) + vesc_.timeout_ns) continue;
    erpm_.at(i) = 0;
    drive();
  }
  TwoWheelEmulator::tick(now_ns);
}

std::int64_t VescEmulator::due_ns() const {
  std::int64_t due_ns = TwoWheelEmulator::due_ns();
  for (std::size_t i = 0; i < 2; ++i) {
    if (erpm_.at(i) != 0) due_ns = std::min(due_ns, commanded_ns_.at(i) + vesc_.timeout_ns);
  }
  return due_ns;
}

}  // namespace topogeo::simulation
