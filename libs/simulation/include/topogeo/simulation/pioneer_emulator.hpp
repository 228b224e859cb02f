// The server of a Pioneer (ARCOS): synchronization, motors, a watchdog of two seconds that forgets
// no speeds, sonars in turns.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "topogeo/devices/pioneer_protocol.hpp"
#include "topogeo/devices/pioneer_settings.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/simulation/two_wheel_emulator.hpp"

namespace topogeo::simulation {

struct PioneerEmulatorSettings {
  devices::LineSettings line{9600, devices::Parity::kNone};
  devices::PioneerSettings units{};
  double battery_v = 12.6;
  std::size_t sonars = 8;
  std::int64_t report_ns = 100'000'000;      ///< from report to report
  std::int64_t watchdog_ns = 2'000'000'000;  ///< without a command until it stops
  std::uint64_t seed = 1;
};

class PioneerEmulator final : public TwoWheelEmulator {
 public:
  /// Switched on at `now_ns`.
  explicit PioneerEmulator(const PioneerEmulatorSettings& settings, std::int64_t now_ns = 0);

  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  void stand_still(std::int64_t duration_ns) override;
  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  void press_emergency_stop() override;
  void release_emergency_stop() override { stop_pressed_ = false; }

  /// Somebody presses the button Motors.
  void switch_motors_off() { motors_ = false; }
  void block_wheel(bool blocked) { seen_.stalls = blocked ? devices::kPioneerLeftStall : 0; }
  /// The range that a sonar measures, in its unit; until then 5,000, no echo.
  void set_sonar(std::size_t number, std::uint16_t range) { ranges_.at(number) = range; }
  /// The next commands of this number are lost.
  void lose(std::uint8_t command, int times) { lost_command_ = command, losses_ = times; }
  /// Whether a client is connected and has opened the server.
  [[nodiscard]] bool open() const { return link_ == Link::kOpen; }
  [[nodiscard]] bool sonars_fire() const { return sonars_fire_; }
  /// mm/s^2; 0: never set.
  [[nodiscard]] int deceleration_mmps2() const { return deceleration_mmps2_; }

 private:
  enum class Link : std::uint8_t { kWaiting, kConnected, kOpen };

  void obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void report(std::int64_t now_ns) override;
  void forget() override;
  [[nodiscard]] bool motors_on() const override { return motors_ && !stop_pressed_; }

  void obey_order(const devices::PioneerOrder& order, std::int64_t now_ns);
  void synchronize(std::uint8_t step, std::int64_t now_ns);
  void close();
  void drive();
  /// Follows the wheels since the last report.
  void follow_wheels();
  void add_echoes();

  PioneerEmulatorSettings pioneer_;
  devices::PioneerReader reader_;
  devices::PioneerReport seen_;
  std::array<std::uint16_t, 16> ranges_{};
  Link link_ = Link::kWaiting;
  std::uint8_t next_sync_ = 0;
  bool motors_ = false;
  bool stop_pressed_ = false;
  bool sonars_fire_ = false;
  int deceleration_mmps2_ = 0;
  geometry::Velocity setpoint_{};
  std::int64_t heard_ns_ = 0;  // last command
  bool waits_ = false;         // the watchdog has stopped it
  geometry::Pose2 T_server_robot_;
  std::array<std::int64_t, 2> last_ticks_{};
  double last_heading_rad_ = 0.0;
  std::size_t next_sonar_ = 0;
  std::uint8_t lost_command_ = 0;
  int losses_ = 0;
};

}  // namespace topogeo::simulation
