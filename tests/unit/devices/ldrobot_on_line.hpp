// A driver and an emulated LDROBOT laser on a simulated line.
#pragma once

#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/ldrobot_driver.hpp"
#include "topogeo/simulation/ldrobot_emulator.hpp"

#include "turning_laser_on_line.hpp"

namespace topogeo::devices {

struct LdRobotOnLine : TurningLaserOnLine<LdRobotDriver, simulation::LdRobotEmulator> {
  explicit LdRobotOnLine(const TurningLaserSettings& settings = {},
                         const simulation::LdRobotEmulatorSettings& laser = {})
      : TurningLaserOnLine(laser, laser_model("ld19"), settings) {}
};

}  // namespace topogeo::devices
