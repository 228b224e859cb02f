// A base with two wheels that speaks the line protocol (docs/base_protocol.md), like the sketch of
// examples/arduino_base: it obeys speeds for a moment, and stops when none come.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/text_base_protocol.hpp"
#include "topogeo/devices/text_base_settings.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct TextBaseEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  double ticks_per_m = devices::TextBaseSettings().ticks_per_m;
  double track_m = devices::TextBaseSettings().track_m;
  bool gyro = false;  ///< it reports a rate of turn
  int version = devices::kTextBaseVersion;
  double battery_v = 12.3;
  std::optional<std::uint8_t> battery_percent{};  ///< it measures its charge
  double acceleration_mps2 = 2.0;                 ///< of each wheel
  std::int64_t report_ns = 20'000'000;            ///< from report to report
  std::int64_t start_up_ns = 1'000'000'000;       ///< after power-on
  std::uint64_t seed = 1;                         ///< of the places of faults
};

class TextBaseEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit TextBaseEmulator(const TextBaseEmulatorSettings& settings, std::int64_t now_ns = 0);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  void stand_still(std::int64_t duration_ns) override;
  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  void press_emergency_stop() override { emergency_stop_ = true; }
  void release_emergency_stop() override { emergency_stop_ = false; }

 private:
  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void obey_line(std::string_view body, std::int64_t now_ns);
  void report(std::int64_t now_ns) override;
  void forget() override;
  [[nodiscard]] bool motors_on() const override { return !emergency_stop_; }
  void greet(std::int64_t now_ns);
  /// Whether the wheels are to turn.
  [[nodiscard]] bool holds() const { return wanted_mps() != std::array<double, 2>{}; }

  TextBaseEmulatorSettings text_;
  devices::TextBaseReader reader_;
  bool greeted_ = false;            // it said hello after its start-up
  std::int64_t hold_until_ns_ = 0;  // of the last speeds
  bool emergency_stop_ = false;
  bool watchdog_ = false;
  bool bumper_ = false;
};

}  // namespace topogeo::simulation
