// Drives an RWI B21 base over the serial line of its controller (MCP), in either dialect: starts it
// up, arms and refreshes its watchdog, passes motion commands on, halts it when they cease, when it
// is stopped or taken over by hand, and makes odometry of its reports. No input or output: see
// serial_driver.hpp.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "topogeo/devices/base_motion.hpp"
#include "topogeo/devices/base_odometer.hpp"
#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/base_watch.hpp"
#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_binary.hpp"
#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::devices {

/// Where more than one holds, the first of the list from kOffline to kMotorsOff.
enum class BaseState : std::uint8_t {
  kReady,            ///< takes motion commands and stands still
  kMoving,           ///< is in motion as commanded
  kOffline,          ///< no line to the base, or it does not answer
  kStarting,         ///< is being set up
  kEmergencyStop,    ///< motion was commanded and the motors have no power; until reset_stop()
  kHalted,           ///< by halt(); until reset_stop()
  kWatchdogExpired,  ///< the base has stopped by itself; until the next motion command
  kBumped,           ///< a bumper is pressed, or was and the commands that led to it go on
  kJoystick,         ///< moves as nobody has commanded
  kMotorsOff         ///< the motors are limp, or one of them has a fault
};
std::string_view base_state_name(BaseState state);

struct BaseStatus {
  BaseState state = BaseState::kOffline;
  std::string reason;           ///< for people; empty when ready or moving
  bool commands_taken = false;  ///< false: motion commands are refused, see state
  double battery_v = 0.0;       ///< 0 where the base has not said it
  bool battery_low = false;
  std::uint16_t bumpers = 0;  ///< a bit for each switch that is pressed
  // Since the driver was made:
  std::uint64_t reports = 0;            ///< that were used
  std::uint64_t echoes = 0;             ///< lines that repeated one of our commands
  std::uint64_t checksum_warnings = 0;  ///< frames that were taken in spite of their checksum
  std::uint64_t restarts = 0;           ///< of the base, seen by its clock or registers
  std::uint64_t starts = 0;             ///< times that the driver set the base up
  std::uint64_t watchdog_expirations = 0;
  McpDrops drops{};  ///< see drop_name()
};

class BaseDriver final : public SerialDriver {
 public:
  /// Throws std::invalid_argument for settings out of range.
  explicit BaseDriver(const BaseSettings& settings);

  // SerialDriver.
  void opened(std::int64_t now_ns) override;
  void lost(std::int64_t now_ns) override;
  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  void tick(std::int64_t now_ns) override;
  [[nodiscard]] std::int64_t due_ns() const override;
  [[nodiscard]] std::vector<LineOrder> take_orders() override;

  /// Drives with these velocities (cut down to the limits) until `valid_until_ns` or for
  /// settings.command_timeout_s, whichever ends first, then halts. False if the command is refused,
  /// see BaseStatus::commands_taken. Both 0 halts and is never refused. Throws
  /// std::invalid_argument for velocities that are not finite.
  bool command(double linear_mps, double angular_radps, std::int64_t valid_until_ns,
               std::int64_t now_ns);
  /// Goes straight on by `distance_m` (backward if negative), with the limits' velocity, halting at
  /// `valid_until_ns` wherever it is then. False if refused; throws as command().
  bool advance(double distance_m, std::int64_t valid_until_ns, std::int64_t now_ns);
  /// Turns on the spot by `angle_rad`, counter-clockwise.
  bool turn(double angle_rad, std::int64_t valid_until_ns, std::int64_t now_ns);
  /// Whether the last advance() or turn() has come to its end, wherever that is. False while it
  /// runs; true while none was ordered.
  [[nodiscard]] bool primitive_done() const { return !primitive_; }

  /// Stops now and refuses motion commands until reset_stop().
  void halt(std::int64_t now_ns);
  /// Both axes were told to halt, and the base has reported since that it stands.
  [[nodiscard]] bool stands() const;
  /// An operator says that it may move again after halt() or an emergency stop. It does not move
  /// before the next command.
  void reset_stop(std::int64_t now_ns);
  /// Each > 0 and never over those of the settings; holds at once. Throws std::invalid_argument for
  /// limits that are not finite and positive.
  void set_limits(const BaseLimits& limits, std::int64_t now_ns);
  [[nodiscard]] const BaseLimits& limits() const { return motion_.limits(); }

  /// Odometry since the last call; stamps increase strictly over the driver's whole life.
  [[nodiscard]] std::vector<BaseOdometry> take_odometry();
  [[nodiscard]] const BaseStatus& status() const { return status_; }

 private:
  enum class Phase : std::uint8_t {
    kClosed,
    kStarting,  ///< writes the start sequence
    kWaiting,   ///< for the first report after it
    kRunning,
    kProbing  ///< asks now and then whether anything answers
  };
  struct Write {
    LineOrder order{};
    std::int64_t pause_ns = 0;  ///< to the next, in any case
  };
  struct Primitive {
    std::int64_t until_ns = 0;
    std::optional<std::int64_t> told_ns{};  ///< when the base was told
  };

  void start(std::int64_t now_ns);
  void probe(std::int64_t now_ns);
  [[nodiscard]] bool answered(std::span<const std::uint8_t> bytes);
  void run(std::int64_t now_ns);
  void go_offline(std::string reason, std::int64_t now_ns);

  void take(const McpReport& report, std::int64_t now_ns);
  void take(const McpEvent& event, std::int64_t now_ns);
  void take(const McpAnswer& answer, std::int64_t now_ns);
  void after_report(std::int64_t now_ns);
  void watch_bumpers(std::uint16_t active_low, std::int64_t now_ns);
  void stand(std::int64_t now_ns);
  void motor_fault(std::string reason, std::int64_t now_ns);
  void check_time_outs(std::int64_t now_ns);

  [[nodiscard]] bool accept_motion(bool motion, std::int64_t now_ns);
  void aim_changed(std::int64_t now_ns);
  [[nodiscard]] bool commands_taken() const;
  void update_status();
  [[nodiscard]] BaseState state() const;
  [[nodiscard]] std::string reason() const;

  /// Writes the next thing that is due, if the line is free.
  void pump(std::int64_t now_ns);
  [[nodiscard]] std::optional<McpOrder> next_order(std::int64_t now_ns);
  void write(const McpOrder& order, std::int64_t now_ns);
  void write(Write write, std::int64_t now_ns);

  BaseSettings settings_;
  McpUnits units_;
  std::int64_t period_ns_;
  std::variant<McpAsciiDecoder, McpBinaryDecoder> decoder_;
  BaseOdometer odometer_;
  BaseMotion motion_;
  BaseWatch watch_;

  Phase phase_ = Phase::kClosed;
  std::deque<Write> script_{};
  std::vector<LineOrder> orders_{};
  std::int64_t free_ns_ = 0;         // when the next thing may be written
  std::int64_t phase_until_ns_ = 0;  // of kWaiting and kProbing
  bool reconnects_ = false;          // kStarting after a silence
  bool answered_ = false;            // something did, since the last start
  std::int64_t started_ns_ = 0;
  std::string probe_answer_{};   // the end of what came since the last question
  std::int64_t heard_ns_ = 0;    // when the last usable report came
  std::int64_t refresh_ns_ = 0;  // when the watchdog is due
  std::int64_t battery_ns_ = 0;  // when the battery is to be asked
  bool acknowledge_ = false;
  bool more_to_say_ = false;  // as soon as the line is free
  bool repeat_settings_ = false;
  unsigned repeated_ = 0;

  std::optional<std::int64_t> command_until_ns_{};
  std::optional<Primitive> primitive_{};
  std::int64_t last_motion_command_ns_ = 0;
  bool stopped_ = false;
  bool halted_ = false;
  std::optional<std::uint64_t> reports_at_halt_{};  // when both axes had been told to halt
  bool watchdog_expired_ = false;
  bool bump_latched_ = false;
  bool joystick_halted_ = false;  // the base was told to halt when the joystick took over
  std::string motor_fault_{};
  std::string offline_reason_{};

  std::vector<BaseOdometry> odometry_{};
  McpDrops implausible_{};
  BaseStatus status_{};
};

}  // namespace topogeo::devices
