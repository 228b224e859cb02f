// A world with a robot whose laser and base are emulated on serial lines, by the world's clock.
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
  simulation::BaseEmulatorSettings base;    ///< its seed is replaced by the robot's
  simulation::LaserEmulatorSettings laser;  ///< its seed is replaced by the robot's
  simulation::RobotOptions robot;
};

/// All times are nanoseconds of the world's clock and never go back.
class SimulatedDevices {
 public:
  /// Switches the devices on at time 0, with their ports plugged in. Throws what SimulatedRobot,
  /// make_device_port(), DevicePort::plug and the emulators throw.
  SimulatedDevices(world::World world, const DeviceOptions& options);

  /// Advances the world and the devices to `now_ns` and exchanges bytes with the ports.
  void run_until(std::int64_t now_ns);

  /// Holds the world still for this time, while the clocks of the devices go on. The watchdog of
  /// the base waits, too, because the base cannot hear its host meanwhile.
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
  /// Number of bytes from the devices that were lost because nothing read them in time.
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

/// The bumper switches that a contact at `direction_rad` from the heading presses: one bit for each
/// of the base's sixteen switches, counter-clockwise from straight ahead.
std::uint16_t bumper_bits(double direction_rad);

}  // namespace topogeo::simulator
