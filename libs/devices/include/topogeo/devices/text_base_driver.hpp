// Drives a base that speaks the line protocol (docs/base_protocol.md): asks who it is, and sends it
// speeds that it obeys for a moment only.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "topogeo/devices/text_base_protocol.hpp"
#include "topogeo/devices/two_wheel_driver.hpp"

namespace topogeo::devices {

class TextBaseDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit TextBaseDriver(const BaseSettings& settings);

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { reader_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  void write_stop() override;
  void count_drops(McpDrops& drops) const override;

  void obey(const TextBaseMessage& message, std::int64_t now_ns);
  void write_line(const std::string& body);

  TextBaseReader reader_;
  std::uint64_t bad_fields_ = 0;
};

}  // namespace topogeo::devices
