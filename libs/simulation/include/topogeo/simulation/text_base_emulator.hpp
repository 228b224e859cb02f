// A base with two wheels that speaks the line protocol (docs/base_protocol.md), like the sketch of
// examples/arduino_base: it obeys speeds for a moment, and stops when none come.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/devices/text_base_protocol.hpp"
#include "topogeo/devices/text_base_settings.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/serial_output.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

struct TextBaseEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  double ticks_per_m = devices::TextBaseSettings().ticks_per_m;
  double track_m = devices::TextBaseSettings().track_m;
  bool gyro = false;  ///< it reports a rate of turn
  int version = devices::kTextBaseVersion;
  double battery_v = 12.3;
  double acceleration_mps2 = 2.0;            ///< of each wheel
  std::int64_t report_ns = 20'000'000;       ///< from report to report
  std::int64_t start_up_ns = 1'000'000'000;  ///< after power-on
  std::uint64_t seed = 1;                    ///< of the places of faults
};

class TextBaseEmulator final : public BaseEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit TextBaseEmulator(const TextBaseEmulatorSettings& settings, std::int64_t now_ns = 0);

  // Interface of SerialDevice.
  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;

  // Interface of BaseEmulator.
  void stand_still(std::int64_t duration_ns) override;
  [[nodiscard]] geometry::Velocity commanded_velocity() const override;
  void moved(double forward_m, double turn_rad, double time_s) override;
  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  void take_joystick(const geometry::Velocity& /*velocity*/) override {}
  void press_emergency_stop() override { emergency_stop_ = true; }
  void release_emergency_stop() override { emergency_stop_ = false; }
  void switch_off(std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;
  void set_fault(BaseFault fault, bool on) override;
  void send_garbage(std::size_t bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::uint64_t reports() const override { return reports_; }

 private:
  void obey(std::string_view body, std::int64_t now_ns);
  void say(std::string line, std::int64_t now_ns);
  void stop() { wanted_mps_ = {}; }

  TextBaseEmulatorSettings settings_;
  devices::TextBaseReader reader_;
  SerialOutput output_;
  support::Random random_;
  bool on_ = true;
  bool greeted_ = false;            // it said hello after its start-up
  std::int64_t ready_ns_ = 0;       // end of the start-up
  std::int64_t next_ns_ = 0;        // of the reports
  std::int64_t began_ns_ = 0;       // its clock
  std::int64_t hold_until_ns_ = 0;  // of the last speeds
  std::array<double, 2> wanted_mps_{};
  std::array<double, 2> wheels_mps_{};
  std::array<double, 2> wheels_m_{};
  double turn_radps_ = 0.0;
  bool emergency_stop_ = false;
  bool watchdog_ = false;
  bool bumper_ = false;
  bool corrupts_ = false;
  bool truncates_ = false;
  bool silent_ = false;
  std::uint64_t reports_ = 0;
};

}  // namespace topogeo::simulation
