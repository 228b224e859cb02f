// Drives an iRobot Create 2 or Roomba by its Open Interface: starts its stream and its safe mode,
// and sends it the speeds of its wheels.
//
// The device keeps its last speeds until it gets others. It stops by itself only at a wheel drop, a
// cliff ahead or a charger, where it falls back to its passive mode. That counts as an emergency
// stop: the driver requests the safe mode again only after reset_stop(). When commands cease, the
// driver sends speeds of 0. If the driver hangs, its watchdog sends stop_bytes().
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "topogeo/devices/create_protocol.hpp"
#include "topogeo/devices/frame_times.hpp"
#include "topogeo/devices/two_wheel_driver.hpp"

namespace topogeo::devices {

class CreateDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit CreateDriver(const BaseSettings& settings);

  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { decoder_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  void released(std::int64_t now_ns) override;
  [[nodiscard]] std::string_view hindrance() const override;
  void count_drops(McpDrops& drops) const override;

  void obey(const CreateReport& report, std::int64_t time_ns, std::int64_t now_ns);
  /// Learns the number of the passive mode from the frames that the device sends after the start,
  /// because devices number their modes differently.
  void learn_passive(std::uint8_t mode);
  [[nodiscard]] bool obeys_speeds() const;
  [[nodiscard]] Signs signs_of(const CreateReport& report) const;
  /// Requests the safe mode. Does nothing if the device is in safe mode or on its charger, if a
  /// stop holds, or if the last request is recent.
  void want_safe_mode(std::int64_t now_ns);

  CreateDecoder decoder_;
  FrameTimes times_;
  std::uint8_t mode_ = 0;
  std::optional<std::uint8_t> passive_mode_;  // number of the passive mode
  unsigned frames_until_passive_ = 0;         // frames left that may be from before the start
  bool charger_ = false;
  bool was_safe_ = false;  // since the driver last made it passive
  std::int64_t asked_safe_ns_ = 0;
  unsigned safe_requests_ = 0;  // consecutive requests without effect
};

}  // namespace topogeo::devices
