// The common part of emulated bases with two wheels: the wheels, power, and faults of their
// messages.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/serial_output.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {

struct TwoWheelEmulatorSettings {
  devices::LineSettings line{115'200, devices::Parity::kNone};
  double ticks_per_m = 2000.0;
  double track_m = 0.2;
  double acceleration_mps2 = 2.0;            ///< of each wheel
  std::int64_t report_ns = 20'000'000;       ///< from report to report
  std::int64_t start_up_ns = 1'000'000'000;  ///< after power-on
  std::uint64_t seed = 1;                    ///< of the places of faults
  unsigned corrupted_bits = 8;               ///< low bits of a byte that a fault may change
};

class TwoWheelEmulator : public BaseEmulator {
 public:
  // Interface of SerialDevice.
  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) final;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) final;

  // Interface of BaseEmulator.
  void stand_still(std::int64_t duration_ns) override { next_ns_ += duration_ns; }
  [[nodiscard]] geometry::Velocity commanded_velocity() const final;
  void moved(double forward_m, double turn_rad, double time_s) final;
  void take_joystick(const geometry::Velocity& /*velocity*/) final {}
  void switch_off(std::int64_t now_ns) final;
  void switch_on(std::int64_t now_ns) final;
  void set_fault(BaseFault fault, bool on) final;
  void send_garbage(std::size_t bytes, std::int64_t now_ns) final;
  [[nodiscard]] std::uint64_t reports() const final { return reports_; }

 protected:
  /// Switched off.
  explicit TwoWheelEmulator(const TwoWheelEmulatorSettings& settings)
      : settings_(settings), random_(settings.seed) {}

  // The family.
  virtual void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  virtual void report(std::int64_t now_ns) = 0;
  /// Its power went: all that it was told is lost.
  virtual void forget() = 0;

  /// Whether the motors have power; without it the wheels brake.
  [[nodiscard]] virtual bool motors_on() const { return true; }

  /// Sends a report, with the faults that are on.
  void say_report(std::vector<std::uint8_t> message, std::int64_t now_ns);
  /// The same for any other message.
  void say(std::vector<std::uint8_t> message, std::int64_t now_ns);
  /// The motors drive the wheels to these speeds; left and right.
  void want(const std::array<double, 2>& wheels_mps) { wanted_mps_ = wheels_mps; }
  [[nodiscard]] const std::array<double, 2>& wanted_mps() const { return wanted_mps_; }
  /// Ticks of a wheel since power-on, without wrapping.
  [[nodiscard]] std::int64_t ticks(std::size_t wheel) const;
  [[nodiscard]] double heading_rad() const { return heading_rad_; }
  [[nodiscard]] double turn_radps() const { return turn_radps_; }
  [[nodiscard]] std::int64_t began_ns() const { return began_ns_; }
  [[nodiscard]] bool has_started(std::int64_t now_ns) const { return on_ && now_ns >= ready_ns_; }

 private:
  TwoWheelEmulatorSettings settings_;
  SerialOutput output_;
  support::Random random_;
  bool on_ = false;
  std::int64_t ready_ns_ = 0;  // end of the start-up
  std::int64_t next_ns_ = 0;   // of the reports
  std::int64_t began_ns_ = 0;  // its clock
  std::array<double, 2> wanted_mps_{};
  std::array<double, 2> wheels_mps_{};
  std::array<double, 2> wheels_m_{};
  double heading_rad_ = 0.0;
  double turn_radps_ = 0.0;
  bool corrupts_ = false;
  bool truncates_ = false;
  bool silent_ = false;
  std::uint64_t reports_ = 0;
};

}  // namespace topogeo::simulation
