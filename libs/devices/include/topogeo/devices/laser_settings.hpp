// Settings of a laser of any model.
#pragma once

#include "topogeo/devices/lds_settings.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/rplidar_settings.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

struct LaserModel;

/// Each driver uses its own part.
struct LaserSettings {
  const LaserModel* model = nullptr;  ///< a row of laser_models(); none: the first
  PlsSettings pls;
  LdsSettings lds;
  RpLidarSettings rplidar;
  TurningLaserSettings turning;  ///< of a laser with a field of view of a full turn
};

}  // namespace topogeo::devices
