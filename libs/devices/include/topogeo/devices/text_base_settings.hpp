// Settings that only a base with the line protocol has (docs/base_protocol.md).
#pragma once

#include <cstdint>

namespace topogeo::devices {

struct TextBaseSettings {
  /// Encoder ticks of a wheel per metre. Measure it before the first drive: half the number is
  /// twice the speed in the odometry.
  double ticks_per_m = 2000.0;
  /// Distance between the two wheels.
  double track_m = 0.2;
  /// The base gets its speed and its rate of turn (W) and mixes them itself; otherwise the speeds
  /// of its wheels (V).
  bool mixes = false;
  /// The heading follows the gyro where the base reports one, not the wheels.
  bool gyro = true;
};

}  // namespace topogeo::devices
