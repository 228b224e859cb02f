// Settings of the tracking of scans between stops.
#pragma once

#include "topogeo/localization/matching/odometry_config.hpp"

namespace topogeo::localization {

struct ScanTrackerConfig {
  OdometryNoise odometry;
  double smallest_overlap = 0.3;  ///< below it a scan is placed by odometry alone
  double smallest_inliers = 0.6;
  double largest_mahalanobis2 = 16.0;
};

}  // namespace topogeo::localization
