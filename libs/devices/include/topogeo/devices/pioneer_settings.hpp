// Settings that only an ActivMedia, MobileRobots or Adept Pioneer has.
#pragma once

namespace topogeo::devices {

struct PioneerSettings {
  /// Units of the position per metre: millimetres with ARCOS. Older firmware counts in units of
  /// its own (DistConvFactor of the maker's parameter files).
  double units_per_m = 1000.0;
  /// Units of the heading per turn.
  double units_per_turn = 4096.0;
  /// Units of the sonars' ranges per metre.
  double sonar_units_per_m = 1000.0;
  /// The sonars fire, which can be heard.
  bool sonars = false;
};

}  // namespace topogeo::devices
