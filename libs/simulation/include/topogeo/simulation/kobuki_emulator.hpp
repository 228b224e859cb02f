// A Kobuki (TurtleBot 2): reports by itself, and obeys its last speed and radius for ever, because
// no source says that it stops.
#pragma once

#include <cstdint>
#include <span>

#include "topogeo/devices/kobuki_protocol.hpp"
#include "topogeo/devices/kobuki_settings.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct KobukiEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  devices::KobukiSettings wheels{};
  double battery_v = 16.2;
  std::uint64_t seed = 1;
};

class KobukiEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit KobukiEmulator(const KobukiEmulatorSettings& settings, std::int64_t now_ns = 0);

  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  /// Somebody lifts the robot: its wheels drop.
  void press_emergency_stop() override { hang_wheels(true); }
  void release_emergency_stop() override { hang_wheels(false); }

  void hang_wheels(bool hang);
  void set_cliff(bool cliff);
  void set_overcurrent(bool over);
  void set_cable(bool plugged);

 private:
  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void report(std::int64_t now_ns) override;
  void forget() override { reader_.clear(); }

  KobukiEmulatorSettings kobuki_;
  devices::KobukiReader reader_;
  devices::KobukiReport seen_;  // what the sensors see
};

}  // namespace topogeo::simulation
