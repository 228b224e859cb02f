#include "simulated_devices.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace topogeo::simulator {
namespace {

// The world advances in steps of this length, or shorter ones when a device has to act.
constexpr std::int64_t kPiece_ns = 5'000'000;

simulation::LaserEmulatorSettings laser_settings(const DeviceOptions& options) {
  simulation::LaserEmulatorSettings settings = options.laser;
  settings.seed = options.robot.seed;
  return settings;
}

simulation::BaseEmulatorSettings base_settings(const DeviceOptions& options) {
  simulation::BaseEmulatorSettings settings = options.base;
  settings.seed = options.robot.seed;
  return settings;
}

}  // namespace

std::uint16_t bumper_bits(double direction_rad) {
  constexpr int kSwitches = 16;
  const double turn = direction_rad / (2.0 * std::numbers::pi);  // -0.5 ... 0.5
  const int which = static_cast<int>(std::floor((turn + 1.0) * kSwitches)) % kSwitches;
  return static_cast<std::uint16_t>(1U << static_cast<unsigned>(which));
}

SimulatedDevices::SimulatedDevices(world::World world, const DeviceOptions& options)
    : robot_(std::move(world), options.robot),
      laser_(simulation::make_laser_emulator(laser_settings(options),
                                             [this](const simulation::BeamPattern& beams,
                                                    std::int64_t) { return robot_.scan(beams); })),
      base_(simulation::make_base_emulator(base_settings(options))),
      laser_port_(make_device_port(options.laser_port)),
      base_port_(make_device_port(options.base_port)) {
  laser_port_->plug();
  base_port_->plug();
}

void SimulatedDevices::run_until(std::int64_t now_ns) {
  exchange(*laser_, *laser_port_, laser_->parity());
  exchange(*base_, *base_port_, devices::Parity::kNone);
  while (now_ns_ < now_ns) {
    const std::int64_t due_ns = std::min(laser_->due_ns(), base_->due_ns());
    advance(std::min({now_ns, now_ns_ + kPiece_ns, std::max(due_ns, now_ns_ + 1)}));
  }
  exchange(*laser_, *laser_port_, laser_->parity());
  exchange(*base_, *base_port_, devices::Parity::kNone);
}

void SimulatedDevices::advance(std::int64_t to_ns) {
  const double piece_s = static_cast<double>(to_ns - now_ns_) * 1e-9;
  const simulation::EncoderStep wheels = robot_.step(base_->commanded_velocity(), piece_s);
  now_ns_ = to_ns;
  base_->moved(wheels.forward_m, wheels.turn_rad, piece_s);
  const std::optional<double> bumped_rad = robot_.bumped_rad();
  base_->press_bumpers(bumped_rad ? bumper_bits(*bumped_rad) : std::uint16_t{0}, now_ns_);
  base_->tick(now_ns_);
  laser_->tick(now_ns_);
}

void SimulatedDevices::exchange(simulation::SerialDevice& device, DevicePort& port,
                                devices::Parity parity) {
  if (!port.plugged()) {  // the device's output is lost
    static_cast<void>(device.take_output({}, now_ns_));
    return;
  }
  const std::vector<std::uint8_t> received = port.receive();
  const devices::LineSettings host = port.host(parity);
  if (host.baud == 0) {  // no program is there
    static_cast<void>(device.take_output({}, now_ns_));
    return;
  }
  if (!received.empty()) device.receive(received, host, now_ns_);
  bytes_lost_ += port.send(device.take_output(host, now_ns_));
}

}  // namespace topogeo::simulator
