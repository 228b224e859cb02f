// Settings that only a pair of VESC controllers has.
#pragma once

#include <cstdint>

namespace topogeo::devices {

struct VescSettings {
  /// Pairs of poles of a motor.
  std::uint32_t pole_pairs = 7;
  /// Turns of a motor per metre. The default is that of a wheel of 0.2 m and a gear of 10:1.
  double motor_turns_per_m = 15.92;
  /// Distance between the wheels.
  double track_m = 0.4;
  /// The controller on the CAN bus of the one at the port. 0 to 253
  std::uint32_t can_id = 2;
  /// The controller at the port drives the right wheel.
  bool port_is_right = false;
  /// A motor turns backwards when the robot drives ahead.
  bool left_reversed = false;
  bool right_reversed = false;
};

}  // namespace topogeo::devices
