// The two motors of an emulated RWI base: the orders that move them, and what its encoders count.
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
  /// Throws std::invalid_argument for a calibration that cannot be.
  explicit McpDrive(const devices::McpCalibration& calibration);

  /// As after power-on: the motors stand, all that was commanded and has been counted is gone.
  void reset();
  /// False if the order is none of motion.
  bool execute(const devices::McpOrder& order);
  void halt();
  void limp();
  /// A servo error: the translation motor goes limp until it gets a new command.
  void fail() { translation_.limp(); }
  /// By the joystick: follows this velocity, whatever was commanded.
  void follow(const geometry::Velocity& velocity);
  /// Without power the wheels are braked.
  void set_power(bool power) { power_ = power; }

  /// Lets time pass until `now_ns`.
  void advance(std::int64_t now_ns);
  /// So much time has passed without anything happening.
  void stand_still(std::int64_t duration_ns) { advanced_ns_ += duration_ns; }
  /// What the encoders of the wheels saw in the last `time_s`: forward and counter-clockwise.
  void moved(double forward_m, double turn_rad, double time_s);

  /// How the motors turn the wheels; robot frame.
  [[nodiscard]] geometry::Velocity commanded_velocity() const;
  [[nodiscard]] bool moves() const { return translation_.moves() || rotation_.moves(); }
  /// As of when the motors are.
  [[nodiscard]] std::int64_t advanced_ns() const { return advanced_ns_; }
  /// All that the encoders saw since it was made, each step half its turn, forward, the other half.
  [[nodiscard]] const geometry::Pose2& T_start_robot() const { return T_start_robot_; }

  // As the base reports it.
  [[nodiscard]] std::uint32_t translate_register() const;
  [[nodiscard]] std::uint32_t rotate_register() const;
  /// Sets place, heading, speeds and states of the motors, as far as the mask has them.
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
  double heading_rad_ = 0.0;        // the same, not wrapped
  geometry::Pose2 T_start_robot_{};
};

}  // namespace topogeo::simulation
