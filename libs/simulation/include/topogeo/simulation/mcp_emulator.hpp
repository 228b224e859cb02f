// An RWI B21 base behind its serial line: both dialects of the controller (MCP), the motors'
// motion, the reports, the watchdog, the joystick, the emergency stop, and faults on demand. The
// world decides the real motion of the wheels: see commanded_velocity() and moved().
//
// McpOrderReader reads the line, McpDrive moves the motors, McpLineFaults damages the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/base_emulator.hpp"
#include "topogeo/simulation/mcp_drive.hpp"
#include "topogeo/simulation/mcp_line_faults.hpp"
#include "topogeo/simulation/mcp_order_reader.hpp"
#include "topogeo/simulation/serial_output.hpp"

namespace topogeo::simulation {

struct McpEmulatorSettings {
  devices::LineSettings line{};
  devices::McpCalibration calibration{};
  /// Time between power-on and its first understanding of input.
  std::int64_t start_up_ns = 2'000'000'000;
  /// Format of its lines and numbers in the ASCII dialect.
  devices::McpAsciiForm form{};
  /// Puts a `*` before its answers.
  bool prompt = false;
  /// Echoes its input until HD, or forever: no publication decides it.
  bool echo_at_start = true;
  bool echo_can_be_switched_off = true;
  /// On expiry of the watchdog the motors go limp; otherwise they halt.
  bool watchdog_limps = false;
  std::uint32_t clock_at_start = 0;
  double clock_drift_ppm = 0.0;  ///< its seconds are this much shorter than ours
  double battery_v = 48.2;
  std::uint64_t seed = 1;  ///< of the places of faults
};

class McpEmulator final : public BaseEmulator {
 public:
  /// Switched on at `now_ns`. Throws std::invalid_argument for an impossible calibration.
  explicit McpEmulator(const McpEmulatorSettings& settings, std::int64_t now_ns = 0);

  // Interface of SerialDevice.
  void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
               std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                      std::int64_t now_ns) override;

  // Interface of BaseEmulator.
  void stand_still(std::int64_t duration_ns) override;
  [[nodiscard]] geometry::Velocity commanded_velocity() const override {
    return drive_.commanded_velocity();
  }
  void moved(double forward_m, double turn_rad, double time_s) override {
    drive_.moved(forward_m, turn_rad, time_s);
  }
  void press_bumpers(std::uint16_t pressed, std::int64_t now_ns) override;
  /// No effect while the host has switched the joystick off.
  void take_joystick(const geometry::Velocity& velocity) override;
  void press_emergency_stop() override { drive_.set_power(false); }
  void release_emergency_stop() override { drive_.set_power(true); }
  void switch_off(std::int64_t now_ns) override;
  void switch_on(std::int64_t now_ns) override;
  void set_fault(BaseFault fault, bool on) override;
  void send_garbage(std::size_t bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::uint64_t reports() const override { return reports_; }

  /// Sum of all encoder steps since construction, each as half its turn, forward, the other half.
  [[nodiscard]] const geometry::Pose2& T_start_robot() const { return drive_.T_start_robot(); }
  void set_battery(double battery_v, std::int64_t now_ns);
  /// A servo error: the translation motor goes limp until it gets a new command.
  void fail_motor(std::int64_t now_ns);

  // Faults.
  void set_echo(bool echo) { echo_ = echo; }
  [[nodiscard]] McpLineFaults& line_faults() { return faults_; }

  // State for tests.
  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] bool binary() const { return reader_.binary(); }
  [[nodiscard]] bool echoes() const { return echo_; }
  [[nodiscard]] const std::vector<devices::McpOrder>& orders() const { return orders_; }
  void forget_orders() { orders_.clear(); }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  /// The reports that it sends unasked.
  struct Reporting {
    std::uint32_t mask = 0;
    std::int64_t period_ns = 0;
    std::int64_t due_ns = kNever;
  };

  void echo(std::uint8_t byte, std::int64_t now_ns);
  void execute(const devices::McpOrder& order, std::int64_t now_ns);
  bool execute_setting(const devices::McpOrder& order, std::int64_t now_ns);
  void execute_question(const devices::McpOrder& order, std::int64_t now_ns);
  void answer(devices::McpCommand command, std::uint32_t value, std::int64_t now_ns);
  /// Sends a message in the present dialect.
  void send(std::string_view ascii, const std::vector<std::uint8_t>& binary, std::int64_t now_ns);
  void send_bytes(std::vector<std::uint8_t> bytes, std::int64_t now_ns);
  void send_line(std::string line, std::int64_t now_ns);
  void send_report(devices::McpCommand kind, std::uint32_t mask, std::int64_t now_ns);
  [[nodiscard]] devices::McpReport report(std::uint32_t mask, std::int64_t now_ns) const;
  [[nodiscard]] std::uint32_t clock(std::int64_t now_ns) const;
  void expire_watchdog(std::int64_t now_ns);

  McpEmulatorSettings settings_;
  McpOrderReader reader_;
  McpDrive drive_;
  McpLineFaults faults_;
  SerialOutput output_;

  bool on_ = false;
  bool ready_ = false;      // start-up has finished
  std::int64_t on_ns_ = 0;  // time of power-on
  bool echo_ = true;
  Reporting reporting_;
  std::int64_t watchdog_ns_ = kNever;
  bool joystick_off_ = false;
  bool stop_on_bump_ = true;
  std::uint16_t bumpers_ = 0;
  double battery_v_ = 0.0;

  std::vector<devices::McpOrder> orders_;
  std::uint64_t reports_ = 0;
};

}  // namespace topogeo::simulation
