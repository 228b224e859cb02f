// Settings that only an iRobot Create 2 or Roomba has.
#pragma once

namespace topogeo::devices {

struct CreateSettings {
  /// 508.8 counts a turn of a wheel of 72.0 mm, as the maker's specification states; the driver
  /// libcreate takes 78 mm.
  double ticks_per_m = 2249.4;
  /// Distance between the wheels, as the maker's specification states.
  double track_m = 0.235;
};

}  // namespace topogeo::devices
