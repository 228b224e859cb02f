#include "topogeo/localization/calibration/odometry_calibration_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(OdometryCalibrationConfig& config, support::ConfigSchema& schema) {
  schema.add("calibration.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
             "squared distance from what the noise found explains, in standard deviations, above "
             "which a motion is outlying and left out; as the gate of matches");
  schema.add("calibration.blocks", &config.blocks, 4U, 1000U, "",
             "pieces of the log that the bootstrap draws from; more for logs of hours, each must "
             "be long enough to be independent of the next");
  schema.add("calibration.resamples", &config.resamples, 2U, 100'000U, "",
             "refits of the bootstrap that give the spread of each value; more: a steadier spread, "
             "and as much more time");
}

}  // namespace topogeo::localization
