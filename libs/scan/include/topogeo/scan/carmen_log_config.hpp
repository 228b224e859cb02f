// Settings of the reader of CARMEN logs.
#pragma once

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::scan {

struct CarmenLogOptions {
  double range_max_m = 49.9;
  bool detect_no_return = true;
  double jump_s = 60.0;      ///< longest step of the stamps that needs no confirmation
  double range_scale = 1.0;  ///< metres of a recorded range of 1
};

/// Declares the section `scan`.
void describe(CarmenLogOptions& options, support::ConfigSchema& schema);

/// Throws std::invalid_argument naming key, value and range.
void check(const CarmenLogOptions& options);

}  // namespace topogeo::scan
