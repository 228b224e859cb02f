// Drives a Kobuki (TurtleBot 2): it reports 50 times a second by itself, and gets its speed and
// radius again and again.
//
// Its firmware does not act on its own sensors since version 1.1.2, so the driver stops it at a
// wheel drop, a cliff and an overcurrent, and holds it until reset_stop(). No source says whether
// it stops when no speeds come; the driver assumes that it does not.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "topogeo/devices/kobuki_protocol.hpp"
#include "topogeo/devices/two_wheel_driver.hpp"

namespace topogeo::devices {

class KobukiDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit KobukiDriver(const BaseSettings& settings);

  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { decoder_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  [[nodiscard]] std::string_view hindrance() const override;
  void count_drops(McpDrops& drops) const override;

  void obey(const KobukiReport& report, std::int64_t now_ns);

  KobukiDecoder decoder_;
  bool cable_ = false;
};

}  // namespace topogeo::devices
