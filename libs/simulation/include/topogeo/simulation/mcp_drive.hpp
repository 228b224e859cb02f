// The two motors of an emulated RWI base: their orders, and the counts of its encoders.
#pragma once

#include <cstdint>

#include "topogeo/devices/mcp_ascii.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/mcp_units.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/simulation/mcp_axis.hpp"

namespace topogeo::simulation {

class McpDrive {
 public:
  /// Throws std::invalid_argument for an impossible calibration.
  explicit McpDrive(const devices::McpCalibration& calibration);

  /// State after power-on: the motors stand, all commands and counts are lost.
  void reset();
  /// False if the order does not concern motion.
  bool execute(const devices::McpOrder& order);
  void halt();
  void limp();
  /// A servo error: the translation motor goes limp until it gets a new command.
  void fail() { translation_.limp(); }
  /// Driven by joystick: follows this velocity, whatever was commanded.
  void follow(const geometry::Velocity& velocity);
  /// Without power the wheels are braked.
  void set_power(bool power) { power_ = power; }

  /// Lets time pass until `now_ns`.
  void advance(std::int64_t now_ns);
  /// Lets this time pass without any event.
  void stand_still(std::int64_t duration_ns) { advanced_ns_ += duration_ns; }
  /// Motion measured by the wheels' encoders in the last `time_s`: forward and counter-clockwise.
  void moved(double forward_m, double turn_rad, double time_s);

  /// Wheel motion as driven by the motors; robot frame.
  [[nodiscard]] geometry::Velocity commanded_velocity() const;
  [[nodiscard]] bool moves() const { return translation_.moves() || rotation_.moves(); }
  /// Time up to which the motors were advanced.
  [[nodiscard]] std::int64_t advanced_ns() const { return advanced_ns_; }
  /// Sum of all encoder steps since construction, each as half its turn, forward, the other half.
  [[nodiscard]] const geometry::Pose2& T_start_robot() const { return T_start_robot_; }

  // Values as reported by the base.
  [[nodiscard]] std::uint32_t translate_register() const;
  [[nodiscard]] std::uint32_t rotate_register() const;
  /// Sets position, heading, speeds and states of the motors, as far as the mask has them.
  void fill(devices::McpReport& report) const;

 private:
  bool execute_translation(const devices::McpOrder& order);
  bool execute_rotation(const devices::McpOrder& order);

  devices::McpUnits units_;
  McpAxis translation_;
  McpAxis rotation_;
  bool power_ = true;
  std::int64_t advanced_ns_ = 0;
  geometry::Pose2 T_base_robot_{};  // registers
  double heading_rad_ = 0.0;        // the heading, not wrapped
  geometry::Pose2 T_start_robot_{};
};

}  // namespace topogeo::simulation
