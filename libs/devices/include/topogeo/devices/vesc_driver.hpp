// Drives two wheels at a pair of VESC motor controllers: one at the port, the other on its CAN bus.
// Sends the speeds of the motors and asks both for their values again and again.
//
// A controller releases its motor when no command has come for its own timeout, a second unless
// somebody changed it with the maker's program; this driver cannot. stop_bytes() are for who stops
// both sooner when a driver hangs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/devices/two_wheel_driver.hpp"
#include "topogeo/devices/vesc_protocol.hpp"

namespace topogeo::devices {

class VescDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit VescDriver(const BaseSettings& settings);

  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { reader_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  void count_drops(McpDrops& drops) const override;

  void obey(const VescValues& values, std::int64_t now_ns);
  /// Asks both; older answers count no more.
  void poll();
  /// The bytes that reach the controller of a wheel (0: left, 1: right).
  [[nodiscard]] std::vector<std::uint8_t> addressed(std::size_t wheel,
                                                    const VescPacket& packet) const;
  [[nodiscard]] std::size_t wheel_at_port() const;
  [[nodiscard]] bool reversed(std::size_t wheel) const;

  VescReader reader_;
  std::array<std::optional<VescValues>, 2> answers_;  // to the last questions, left and right
  std::uint64_t bad_fields_ = 0;
};

}  // namespace topogeo::devices
