// Settings that only Slamtec RPLIDAR lasers have.
#pragma once

#include <cstdint>

namespace topogeo::devices {

enum class RpScan : std::uint8_t {
  kModel,     ///< kExpress with the working mode of the model
  kStandard,  ///< five bytes a sample, without a checksum: of lasers with old firmware
  kExpress    ///< packets with a checksum
};

enum class RpMotor : std::uint8_t {
  kModel,  ///< by the series that the laser reports
  kNone,   ///< it turns by itself
  kDtr,    ///< the line DTR alone (A1)
  kPwm,    ///< a request with a duty cycle, and DTR (A2, A3 with their adapter)
  kSpeed   ///< a request with a speed (S and C series)
};

struct RpLidarSettings {
  RpScan scan = RpScan::kModel;
  /// Working mode of the express scan: 0 is that of all lasers; others depend on the firmware.
  std::uint8_t express_mode = 0;
  RpMotor motor = RpMotor::kModel;
  /// Duty cycle (0 to 1023) or turns a minute of the motor; 0: 660 and 600.
  std::uint16_t motor_value = 0;
  /// The compensation of an angle has a sign, as the Application Notes state, and not the value
  /// that the maker's own driver reads.
  bool compensation_signed = false;
};

}  // namespace topogeo::devices
