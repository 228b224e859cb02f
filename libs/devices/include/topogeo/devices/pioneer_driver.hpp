// Drives an ActivMedia, MobileRobots or Adept Pioneer (ARCOS, AROS, P2OS): connects to its server,
// switches its motors on, and sends it speed and rate of turn again and again.
//
// The server stops the robot when no command has come for two seconds, a time in its FLASH that no
// command changes, and goes on with the last speeds as soon as one comes: the driver sends speeds
// of 0 before anything else. stop_bytes() are for who stops it sooner when a driver hangs. Motors
// that go off by themselves, a stop button and a blocked wheel count as an emergency stop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "topogeo/devices/frame_times.hpp"
#include "topogeo/devices/pioneer_protocol.hpp"
#include "topogeo/devices/pioneer_sonars.hpp"
#include "topogeo/devices/two_wheel_driver.hpp"

namespace topogeo::devices {

class PioneerDriver final : public TwoWheelDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit PioneerDriver(const BaseSettings& settings);

  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;
  [[nodiscard]] BodySensors* sonars() override { return &sonars_; }
  [[nodiscard]] std::vector<SonarMount> sonar_mounts() const override { return pioneer_sonars(); }

 private:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void forget_bytes() override { reader_.clear(); }
  void ask(unsigned attempt, std::int64_t now_ns) override;
  void write_speeds(const BaseVelocity& velocity) override;
  void released(std::int64_t now_ns) override;
  [[nodiscard]] std::string_view hindrance() const override;
  void count_drops(McpDrops& drops) const override;

  void order(std::uint8_t command, std::optional<int> value = std::nullopt);
  /// The answer to a step of the synchronization: takes the next step, at last opens the server.
  void synchronize(std::uint8_t answered);
  void obey(const PioneerReport& report, std::int64_t time_ns, std::int64_t now_ns);
  [[nodiscard]] Signs signs_of(const PioneerReport& report) const;
  /// Adds the motion since the last report to the wheels.
  void move(const PioneerReport& report);
  void want_motors(std::int64_t now_ns);
  /// One of the server's limits at each report, over and over, because commands may be lost.
  void write_next_limit();

  PioneerReader reader_;
  FrameTimes times_;
  PioneerSonars sonars_;
  std::uint8_t expected_sync_ = 0;
  struct Place {
    std::uint16_t x = 0;
    std::uint16_t y = 0;
    double heading_rad = 0.0;
  };
  std::optional<Place> last_;         // of the server; empty: it has just been opened
  std::array<double, 2> wheels_m_{};  // left and right, since the first report
  bool enabled_ = false;
  bool was_enabled_ = false;  // since the driver last switched the motors on
  std::int64_t asked_motors_ns_ = 0;
  std::size_t next_limit_ = 0;
  std::uint64_t bad_fields_ = 0;
};

}  // namespace topogeo::devices
