// The common part of drivers of bases with two driven wheels: a base that reports by itself, speeds
// that are sent again and again, ramps and limits, stops, and odometry of ticks. The driver of a
// family finds reports in the bytes and writes orders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/devices/base_interlocks.hpp"
#include "topogeo/devices/motion_term.hpp"
#include "topogeo/devices/wheel_odometer.hpp"

namespace topogeo::devices {

class TwoWheelDriver : public BaseDriver {
 public:
  // Interface of SerialDriver.
  void opened(std::int64_t now_ns) final;
  void lost(std::int64_t now_ns) final;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) final;
  void tick(std::int64_t now_ns) final;
  [[nodiscard]] std::int64_t due_ns() const final;
  [[nodiscard]] std::vector<LineOrder> take_orders() final;

  // Interface of BaseDriver.
  bool command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
               std::int64_t now_ns) final;
  void guard_velocities(VelocityGuard guard, std::int64_t period_ns) final;
  void halt(std::int64_t now_ns) final;
  void end(std::int64_t now_ns) final;
  [[nodiscard]] bool stands() const final { return status_.stands; }
  void reset_stop(std::int64_t now_ns) final;
  [[nodiscard]] const HeldStops& held_stops() const final { return interlocks_.held(); }
  void hold_stops(const HeldStops& stops) final;
  void set_limits(const BaseLimits& limits, std::int64_t now_ns) final;
  [[nodiscard]] const BaseLimits& limits() const final { return limits_; }
  [[nodiscard]] std::vector<BaseOdometry> take_odometry() final;
  [[nodiscard]] const BaseStatus& status() const final { return status_; }

 protected:
  /// A report also says this.
  struct Signs {
    /// The base has stopped, or has to stop, until a person releases it; the text says why, and is
    /// empty for the usual reason.
    std::optional<std::string_view> emergency_stop{};
    bool watchdog = false;      ///< it stopped by itself because no speeds came
    std::uint16_t bumpers = 0;  ///< a bit for each that is pressed
  };

  static constexpr std::string_view kWheelHangs =
      "a wheel hangs: put the robot on the floor and release it";
  static constexpr std::string_view kNoFloor =
      "a cliff sensor sees no floor: move the robot away and release it";

  /// Throws std::invalid_argument for settings or units out of range.
  TwoWheelDriver(const BaseSettings& settings, const WheelUnits& units);

  // The family.
  /// Finds messages in received bytes; calls greet(), refuse() and take().
  virtual void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// The start of a message waits for its end no more.
  virtual void forget_bytes() = 0;
  /// Asks for reports. `attempt` counts from 0 since the port was opened or the base last reported.
  virtual void ask(unsigned attempt, std::int64_t now_ns) = 0;
  virtual void write_speeds(const BaseVelocity& velocity) = 0;
  /// Stops the base in addition to speeds of 0, if it has an order for that.
  virtual void write_stop() {}
  /// An operator has released the stops.
  virtual void released(std::int64_t now_ns) { static_cast<void>(now_ns); }
  /// Why a base that reports takes no motion commands; empty: it does.
  [[nodiscard]] virtual std::string_view hindrance() const { return {}; }
  virtual void count_drops(McpDrops& drops) const = 0;

  /// The base has answered: it runs.
  void greet(std::int64_t now_ns);
  /// The base answers, but cannot be used.
  void refuse(const std::string& reason) { disconnect(reason); }
  void take(const WheelReport& report, const Signs& signs, std::int64_t now_ns);
  /// `percent`: of a base that measures its charge, in [0, 100].
  void set_battery(double volts, std::optional<double> percent = std::nullopt);
  void write(std::vector<std::uint8_t> bytes);
  [[nodiscard]] bool runs() const { return link_ == Link::kRunning; }
  [[nodiscard]] bool stopped() const { return interlocks_.engaged(); }
  [[nodiscard]] const BaseSettings& settings() const { return settings_; }
  [[nodiscard]] const WheelUnits& units() const { return odometer_.units(); }

 private:
  enum class Link : std::uint8_t { kClosed, kAsking, kRunning };

  void obey(const Signs& signs, std::int64_t now_ns);
  void disconnect(const std::string& reason);
  /// No command holds any more; the base gets speeds of 0 now.
  void stand(std::int64_t now_ns);
  void send_speeds(std::int64_t now_ns);
  [[nodiscard]] bool commands_taken() const;
  [[nodiscard]] BaseState state() const;
  [[nodiscard]] std::string reason() const;
  void update_status();

  BaseSettings settings_;
  BaseLimits limits_;
  BaseInterlocks interlocks_;
  MotionTerm term_;
  WheelOdometer odometer_;

  Link link_ = Link::kClosed;
  std::string reason_ = "the port is closed";
  bool heard_ = false;                // a report came since the base has answered
  std::int64_t last_arrival_ns_ = 0;  // of a report or the first answer
  std::int64_t asked_ns_ = 0;
  unsigned attempts_ = 0;
  std::int64_t sent_ns_ = 0;  // last speeds
  BaseVelocity wanted_;
  BaseVelocity sent_;
  unsigned at_rest_ = 0;  // reports in a row without motion since speeds of 0 were sent
  std::string emergency_reason_;
  bool ended_ = false;
  std::uint64_t implausible_ = 0;
  VelocityGuard guard_{};
  std::vector<LineOrder> orders_;
  std::vector<BaseOdometry> odometry_;
  BaseStatus status_;
};

}  // namespace topogeo::devices
