// Settings that only a Roboteq controller has.
#pragma once

#include <cstdint>

namespace topogeo::devices {

struct RoboteqSettings {
  /// Encoder counts of a wheel per metre. The default is that of a wheel of 0.2 m, a gear of 20:1
  /// and 1,024 counts a turn of the motor.
  double ticks_per_m = 32'595.0;
  /// Turns of a motor per metre.
  double motor_turns_per_m = 31.83;
  /// Distance between the wheels.
  double track_m = 0.4;
  /// Turns a minute at full speed (`MXRPM` of the controller), for speeds as shares of it (`!G`).
  /// 0: speeds in turns a minute (`!S`).
  double full_rpm = 0.0;
  /// Channel of the left motor, 1 or 2; the right one is the other.
  std::uint32_t left_channel = 1;
  /// A motor turns backwards, and its encoder counts backwards, when the robot drives ahead.
  bool left_reversed = false;
  bool right_reversed = false;
};

}  // namespace topogeo::devices
