// Settings of the tracking of scans between stops.
#pragma once

#include "topogeo/matching/odometry_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

struct ScanTrackerConfig {
  OdometryNoise odometry;  ///< the localizer's
  double smallest_overlap = 0.3;
  double smallest_inliers = 0.6;
  double largest_mahalanobis2 = 16.0;
};

/// Declares the section `tracker`, without the odometry.
void describe(ScanTrackerConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
