// A Roboteq motor controller with two channels: a watchdog that forgets no speeds, encoder counts,
// fault flags.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "topogeo/devices/roboteq_protocol.hpp"
#include "topogeo/devices/roboteq_settings.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct RoboteqEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  devices::RoboteqSettings wheels{};
  double battery_v = 24.6;
  bool echoes = true;          ///< until it is told not to
  bool takes_watchdog = true;  ///< otherwise it keeps its own
  std::uint64_t seed = 1;
};

class RoboteqEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit RoboteqEmulator(const RoboteqEmulatorSettings& settings, std::int64_t now_ns = 0);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  void stand_still(std::int64_t duration_ns) override;
  void press_bumpers(std::uint16_t /*pressed*/, std::int64_t /*now_ns*/) override {}
  void press_emergency_stop() override { emergency_stop_ = true; }
  void release_emergency_stop() override { emergency_stop_ = false; }

  /// It overheats and switches its motors off.
  void overheat(bool hot) { overheats_ = hot; }
  [[nodiscard]] std::int32_t watchdog_ms() const { return watchdog_ms_; }

 private:
  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  /// It answers only.
  void report(std::int64_t /*now_ns*/) override {}
  void forget() override;
  [[nodiscard]] bool motors_on() const override { return !emergency_stop_ && !overheats_; }

  void obey_line(const std::string& line, std::int64_t now_ns);
  /// False: it does not know the command.
  [[nodiscard]] bool run(const devices::RoboteqOrder& order, std::int64_t now_ns);
  [[nodiscard]] bool set(const devices::RoboteqOrder& order);
  void answer(const devices::RoboteqOrder& order, std::int64_t now_ns);
  void drive();
  [[nodiscard]] std::int64_t expires_ns() const;
  /// Channel of a wheel, from 0.
  [[nodiscard]] std::size_t channel(std::size_t wheel) const;
  /// -1 for a wheel whose motor is mounted the other way round, else 1.
  [[nodiscard]] int direction(std::size_t wheel) const;

  RoboteqEmulatorSettings roboteq_;
  std::string line_;
  bool echoes_ = true;
  std::array<double, 2> rpm_{};  // of the channels
  std::int32_t watchdog_ms_ = 0;
  std::int64_t commanded_ns_ = 0;
  bool expired_ = false;
  bool emergency_stop_ = false;
  bool overheats_ = false;
};

}  // namespace topogeo::simulation
