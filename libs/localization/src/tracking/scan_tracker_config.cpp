#include "topogeo/localization/tracking/scan_tracker_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(ScanTrackerConfig& config, support::ConfigSchema& schema) {
  schema.add("tracker.smallest_overlap", &config.smallest_overlap, 0.0, 1.0, "",
             "share of the points of a scan in the view of the last stop below which odometry "
             "alone places the scan");
  schema.add("tracker.smallest_inliers", &config.smallest_inliers, 0.0, 1.0, "",
             "the same for the share of those that lie on a surface");
  schema.add("tracker.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
             "the same above this squared distance from the prediction in standard deviations");
}

}  // namespace topogeo::localization
