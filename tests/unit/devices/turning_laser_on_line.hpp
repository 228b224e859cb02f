// The driver and the emulator of a laser that turns, on a simulated line, in a world that changes
// with every packet, with a check of every beam of the driver's scans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/simulation/laser_emulator.hpp"

#include "measured_beams.hpp"
#include "simulated_line.hpp"

namespace topogeo::devices {

template <class Driver, class Emulator, class World = MeasuredBeams>
class TurningLaserOnLine {
 public:
  /// `laser`: settings of the emulator; the others are the arguments of the driver.
  template <class EmulatorSettings, class... DriverArguments>
  explicit TurningLaserOnLine(const EmulatorSettings& laser, const DriverArguments&... arguments)
      : driver(arguments...),
        emulator(laser, [this](const simulation::BeamPattern& beams,
                               std::int64_t now_ns) { return world.measure(beams, now_ns); }),
        line(driver, emulator),
        world(laser.seed) {}

  /// Takes the driver's scans and counts those with a beam that the laser did not measure.
  void collect() {
    for (LaserScan& scan : driver.take_scans()) {
      if (!world.has(scan)) ++wrong_scans;
      scans.push_back(std::move(scan));
    }
  }

  void run_for(std::int64_t duration_ns) {
    line.run_until(duration_ns, [this] {
      collect();
      return false;
    });
  }

  /// Passes time until the driver has delivered `count` more scans.
  bool run_for_scans(std::size_t count, std::int64_t limit_ns) {
    const std::size_t wanted = scans.size() + count;
    return line.run_until(limit_ns, [&] {
      collect();
      return scans.size() >= wanted;
    });
  }

  Driver driver;
  Emulator emulator;
  SimulatedLine line;
  World world;
  std::vector<LaserScan> scans;
  std::size_t wrong_scans = 0;
};

}  // namespace topogeo::devices
