// Drives a base that speaks the line protocol (docs/base_protocol.md): asks who it is, sends it
// speeds that it obeys for a moment only, halts it when commands cease, and makes odometry of its
// ticks.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/devices/base_interlocks.hpp"
#include "topogeo/devices/device_clock.hpp"
#include "topogeo/devices/motion_term.hpp"
#include "topogeo/devices/text_base_protocol.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {

class TextBaseDriver final : public BaseDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit TextBaseDriver(const BaseSettings& settings);

  // Interface of SerialDriver.
  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;

  // Interface of BaseDriver.
  bool command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
               std::int64_t now_ns) override;
  void guard_velocities(VelocityGuard guard, std::int64_t period_ns) override;
  void halt(std::int64_t now_ns) override;
  void end(std::int64_t now_ns) override;
  [[nodiscard]] bool stands() const override { return status_.stands; }
  void reset_stop(std::int64_t now_ns) override;
  [[nodiscard]] const HeldStops& held_stops() const override { return interlocks_.held(); }
  void hold_stops(const HeldStops& stops) override;
  void set_limits(const BaseLimits& limits, std::int64_t now_ns) override;
  [[nodiscard]] const BaseLimits& limits() const override { return limits_; }
  [[nodiscard]] std::vector<BaseOdometry> take_odometry() override;
  [[nodiscard]] const BaseStatus& status() const override { return status_; }

 private:
  enum class Link : std::uint8_t { kClosed, kAsking, kRunning };

  void take(const TextBaseMessage& message, std::int64_t now_ns);
  void take(const TextBaseReport& report, std::int64_t now_ns);
  /// Whether the base can have sent `report` so soon after the last one.
  [[nodiscard]] bool plausible(const TextBaseReport& report, std::int64_t now_ns) const;
  void move(const TextBaseReport& report, std::int64_t now_ns);
  void obey_flags(const TextBaseReport& report, std::int64_t now_ns);
  void disconnect(const std::string& reason);
  /// No command holds any more; the base gets speeds of 0 now.
  void stand(std::int64_t now_ns);
  void send_speeds(std::int64_t now_ns);
  void write(const std::string& line);
  [[nodiscard]] bool commands_taken() const;
  void update_status();

  BaseSettings settings_;
  BaseLimits limits_;
  TextBaseReader reader_;
  BaseInterlocks interlocks_;
  MotionTerm term_;
  DeviceClock clock_{0};

  Link link_ = Link::kClosed;
  std::string reason_ = "the port is closed";
  std::optional<TextBaseReport> last_;
  std::optional<TextBaseReport> doubted_;  // a report that does not follow last_
  bool heard_ = false;                     // a report came since the hello
  std::int64_t last_arrival_ns_ = 0;       // of a report or the hello
  std::int64_t last_report_ns_ = 0;
  std::int64_t device_ns_ = 0;  // time of the base without wrapping
  std::int64_t asked_ns_ = 0;
  std::int64_t sent_ns_ = 0;  // last speeds
  BaseVelocity wanted_;
  BaseVelocity sent_;
  unsigned at_rest_ = 0;  // reports in a row without motion since speeds of 0 were sent
  geometry::Pose2 T_odom_robot_;
  bool ended_ = false;
  std::uint64_t implausible_ = 0;
  std::uint64_t bad_fields_ = 0;
  VelocityGuard guard_{};
  std::vector<LineOrder> orders_;
  std::vector<BaseOdometry> odometry_;
  BaseStatus status_;
};

}  // namespace topogeo::devices
