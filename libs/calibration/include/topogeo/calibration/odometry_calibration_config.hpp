// Settings of the calibration of odometry and laser.
#pragma once

#include <cstdint>

#include "topogeo/matching/match_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

struct OdometryCalibrationConfig {
  OdometryNoise fallback;  ///< for parameters that the log does not show: the localizer's
  double largest_mahalanobis2 = 25.0;
  std::uint32_t blocks = 20;
  std::uint32_t resamples = 100;
  std::uint64_t seed = 1;  ///< of the bootstrap: the seed of the localizer
};

/// Declares the section `calibration`, without the odometry and the seed.
void describe(OdometryCalibrationConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
