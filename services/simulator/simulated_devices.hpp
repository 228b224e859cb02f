// A world with a robot whose laser and base are on serial lines, on the world's clock.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/laser_emulator.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/world/world.hpp"

#include "device_port.hpp"

namespace topogeo::simulator {

enum class Device { kLaser, kBase };

struct DeviceOptions {
  std::filesystem::path laser_port;  ///< link to create, or tcp://ADDRESS:PORT
  std::filesystem::path base_port;
  simulation::BaseEmulatorSettings base;    ///< its seed is that of the robot
  simulation::LaserEmulatorSettings laser;  ///< its seed is that of the robot
  simulation::RobotOptions robot;
};

/// All times are nanoseconds of the world's clock and never go back.
class SimulatedDevices {
 public:
  /// The devices are switched on at time 0, with their ports plugged in. Throws like
  /// SimulatedRobot, make_device_port(), DevicePort::plug and the emulators.
  SimulatedDevices(world::World world, const DeviceOptions& options);

  /// Advances the world and the devices to `now_ns` and exchanges bytes with the ports.
  void run_until(std::int64_t now_ns);

  /// The world stands still for this time, while the clocks of the devices go on. The base has not
  /// heard its host meanwhile, so its watchdog waits, too.
  void stand_still(std::int64_t duration_ns) {
    now_ns_ += duration_ns;
    base_->stand_still(duration_ns);
  }

  [[nodiscard]] simulation::SimulatedRobot& robot() { return robot_; }
  [[nodiscard]] simulation::LaserEmulator& laser() { return *laser_; }
  [[nodiscard]] simulation::BaseEmulator& base() { return *base_; }
  [[nodiscard]] DevicePort& port(Device device) {
    return device == Device::kLaser ? *laser_port_ : *base_port_;
  }
  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  /// Bytes from the devices that were not read in time.
  [[nodiscard]] std::uint64_t bytes_lost() const { return bytes_lost_; }

 private:
  void advance(std::int64_t to_ns);
  void exchange(simulation::SerialDevice& device, DevicePort& port, devices::Parity parity);

  simulation::SimulatedRobot robot_;
  std::unique_ptr<simulation::LaserEmulator> laser_;
  std::unique_ptr<simulation::BaseEmulator> base_;
  std::unique_ptr<DevicePort> laser_port_;
  std::unique_ptr<DevicePort> base_port_;
  std::int64_t now_ns_ = 0;
  std::uint64_t bytes_lost_ = 0;
};

/// Bits of the base's sixteen bumper switches, counter-clockwise from ahead, that a contact at
/// `direction_rad` from the heading presses.
std::uint16_t bumper_bits(double direction_rad);

}  // namespace topogeo::simulator
