// Drives an RWI B21 base over the serial line of its controller (MCP), in either dialect: starts it
// up, arms and refreshes its watchdog, passes motion commands on, halts it when they cease, when it
// is stopped or taken over by hand, and makes odometry of its reports. No input or output: see
// serial_driver.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/base_decoder.hpp"
#include "topogeo/devices/base_driver.hpp"
#include "topogeo/devices/base_interlocks.hpp"
#include "topogeo/devices/base_link.hpp"
#include "topogeo/devices/base_motion.hpp"
#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_status.hpp"
#include "topogeo/devices/base_upkeep.hpp"
#include "topogeo/devices/base_writer.hpp"
#include "topogeo/devices/motion_monitor.hpp"
#include "topogeo/devices/motion_term.hpp"

namespace topogeo::devices {

class RwiDriver final : public BaseDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit RwiDriver(const BaseSettings& settings);

  // Interface of SerialDriver.
  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;
  void written(std::int64_t now_ns) override {
    orders_written_ = true;
    confirm_aim(now_ns);
  }

  // Interface of BaseDriver.
  bool command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
               std::int64_t now_ns) override;
  void guard_velocities(VelocityGuard guard, std::int64_t period_ns) override;
  void halt(std::int64_t now_ns) override;
  void end(std::int64_t now_ns) override {
    interlocks_.end();
    stand_again(now_ns);
    tick(now_ns);
  }
  /// Both axes were sent a halt, and the base has since reported standstill.
  [[nodiscard]] bool stands() const override;
  void reset_stop(std::int64_t now_ns) override;
  [[nodiscard]] const HeldStops& held_stops() const override { return interlocks_.held(); }
  void hold_stops(const HeldStops& stops) override {
    interlocks_.hold(stops);
    update_status();
  }
  void set_limits(const BaseLimits& limits, std::int64_t now_ns) override;
  [[nodiscard]] const BaseLimits& limits() const override { return motion_.limits(); }
  [[nodiscard]] std::vector<BaseOdometry> take_odometry() override;
  [[nodiscard]] const BaseStatus& status() const override { return status_; }
  void resume_odometry(const OdometerState& state) override { odometer_.resume(state); }
  [[nodiscard]] bool odometry_resumed() const override { return odometer_.has_resumed(); }
  [[nodiscard]] std::optional<OdometerState> odometer_state() const override {
    return odometer_.state();
  }

  /// Drives straight by `distance_m` (backward if negative), with the limits' velocity, halting at
  /// `valid_until_ns` at the latest. False if refused; throws like command().
  bool advance(double distance_m, std::int64_t valid_until_ns, std::int64_t now_ns);
  /// Turns on the spot by `angle_rad`, counter-clockwise.
  bool turn(double angle_rad, std::int64_t valid_until_ns, std::int64_t now_ns);
  /// Whether the last advance() or turn() has ended, for any reason. False while it runs; true if
  /// none was ordered.
  [[nodiscard]] bool primitive_done() const { return !term_.relative_holds(); }

 private:
  void follow(BaseLink::Change change, std::int64_t now_ns);
  void take(const McpReport& report, std::int64_t now_ns);
  void take(const McpEvent& event, std::int64_t now_ns);
  void take(const McpAnswer& answer, std::int64_t now_ns);
  void bump(std::uint16_t active_low, std::int64_t now_ns);
  void check_motion(std::int64_t now_ns);

  [[nodiscard]] bool commands_taken() const;
  [[nodiscard]] bool accept_motion(double linear_mps, std::int64_t now_ns);
  void start_relative(std::int64_t valid_until_ns, std::int64_t now_ns);
  void aim_changed(std::int64_t now_ns);
  [[nodiscard]] BaseVelocity guarded(std::int64_t now_ns);
  void judge_again(std::int64_t now_ns);
  void stand(std::int64_t now_ns);
  void stand_again(std::int64_t now_ns);

  /// Gives the monitor the velocity that is commanded from now on.
  void aim_at(const BaseVelocity& velocity, std::int64_t now_ns);
  /// Once all orders for its aim have been written, the monitor may expect the base to obey.
  void confirm_aim(std::int64_t now_ns);
  [[nodiscard]] bool write_next(std::int64_t now_ns);
  [[nodiscard]] std::optional<McpOrder> next_order(std::int64_t now_ns);

  void update_status();
  [[nodiscard]] BaseState state() const;
  [[nodiscard]] std::string reason() const;

  BaseSettings settings_;
  BaseDecoder decoder_;
  BaseOdometer odometer_;
  BaseMotion motion_;
  MotionMonitor monitor_;
  MotionTerm term_;
  BaseInterlocks interlocks_;
  BaseWriter writer_;
  BaseLink link_;
  BaseUpkeep upkeep_;

  VelocityGuard guard_{};
  std::int64_t judge_period_ns_ = 0;
  std::int64_t judge_ns_ = 0;  // time of the guard's next check
  BaseVelocity wanted_{};      // of the last command, before the guard

  bool idle_ = true;            // no write is due until a time or a message comes
  bool aim_ordered_ = false;    // all orders for the current aim have been given
  bool orders_written_ = true;  // all orders that were taken
  std::optional<std::uint64_t> reports_at_halt_{};  // number of reports when both halts were sent
  std::uint64_t implausible_ = 0;                   // dropped reports
  std::vector<BaseOdometry> odometry_{};
  BaseStatus status_{};
};

}  // namespace topogeo::devices
