// Settings of a laser of any model.
#pragma once

#include "topogeo/devices/cola_settings.hpp"
#include "topogeo/devices/lds_settings.hpp"
#include "topogeo/devices/pls_settings.hpp"
#include "topogeo/devices/rplidar_settings.hpp"
#include "topogeo/devices/safety_settings.hpp"
#include "topogeo/devices/scip_settings.hpp"
#include "topogeo/devices/turning_laser_settings.hpp"

namespace topogeo::devices {

struct LaserModel;

/// Each driver uses its own part.
struct LaserSettings {
  const LaserModel* model = nullptr;  ///< a row of laser_models(); none: the first
  PlsSettings pls;
  LdsSettings lds;
  RpLidarSettings rplidar;
  ScipSettings scip;
  ColaSettings cola;
  SafetySettings safety;
  TurningLaserSettings turning;  ///< of every laser but the PLS
};

}  // namespace topogeo::devices
