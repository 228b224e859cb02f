#include "topogeo/matching/match_config.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(ScanTrackerConfig& config, support::ConfigSchema& schema) {
  schema.add("tracker.smallest_overlap", &config.smallest_overlap, 0.0, 1.0, "",
             "smallest share of a scan's points in the view of the last stop; below it odometry "
             "alone places the scan");
  schema.add("tracker.smallest_inliers", &config.smallest_inliers, 0.0, 1.0, "",
             "smallest share of those points that lie on a surface; below it odometry alone places "
             "the scan");
  schema.add("tracker.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
             "largest squared Mahalanobis distance from the prediction; above it odometry alone "
             "places the scan");
  schema.fix(
      {"tracker.smallest_overlap", "tracker.smallest_inliers", "tracker.largest_mahalanobis2"});
}

}  // namespace topogeo::localization
