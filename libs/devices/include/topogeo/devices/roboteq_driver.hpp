// Drives two wheels at the two channels of a Roboteq motor controller: sets its watchdog, sends the
// speeds of the motors and asks for encoder counts, faults and battery again and again.
//
// The watchdog stops the motors when no runtime command comes, and they go on with their old speeds
// as soon as one comes: the first command is a speed of 0. Lines have no checksum, so flags count
// when they have come several times in a row, and counts when two answers agree.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "topogeo/devices/roboteq_protocol.hpp"
#include "topogeo/devices/two_wheel_driver.hpp"

namespace topogeo::devices {

class RoboteqDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit RoboteqDriver(const BaseSettings& settings);

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { decoder_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  void released(std::int64_t now_ns) override;
  void count_drops(McpDrops& drops) const override;

  void obey(const RoboteqAnswer& answer, std::int64_t now_ns);
  /// Counts of a wheel that moves fast differ little between the two answers of a poll.
  void take_counts(const std::array<std::uint32_t, 2>& counts);
  void take_flags(std::int32_t flags);
  [[nodiscard]] Signs signs() const;
  /// The orders that drive the wheels, left and right.
  [[nodiscard]] std::string speed_lines(const std::array<double, 2>& wheels_mps) const;
  [[nodiscard]] std::int32_t watchdog_ms() const;
  [[nodiscard]] std::string watchdog_line() const;
  void write_text(const std::string& text);
  /// The controller's channels of the left and the right wheel, from 0.
  [[nodiscard]] std::array<std::size_t, 2> channels() const;

  RoboteqDecoder decoder_;
  std::uint64_t bad_fields_ = 0;
  std::optional<std::array<std::uint32_t, 2>> counts_{};       // newest of a read
  std::optional<std::array<std::uint32_t, 2>> last_counts_{};  // newest answer, right or wrong
  std::int32_t flags_ = 0;                                     // that count
  std::int32_t last_flags_ = 0;
  unsigned same_flags_ = 0;  // answers in a row
  unsigned polls_ = 0;
};

}  // namespace topogeo::devices
