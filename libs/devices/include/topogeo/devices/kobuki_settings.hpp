// Settings that only a Kobuki has.
#pragma once

namespace topogeo::devices {

struct KobukiSettings {
  /// The maker's driver has 0.0852921 mm a tick.
  double ticks_per_m = 11'724.4;
  /// Distance between the wheels, of the maker's driver.
  double track_m = 0.23;
  /// The heading follows the gyro, not the wheels.
  bool gyro = true;
};

}  // namespace topogeo::devices
