#include "topogeo/calibration/odometry_calibration_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(OdometryCalibrationConfig& config, support::ConfigSchema& schema) {
  schema.add("calibration.largest_mahalanobis2", &config.largest_mahalanobis2, 1.0, 1000.0, "",
             "largest squared Mahalanobis distance under the fitted noise; a motion above it is an "
             "outlier and is left out, as in the gate of matches");
  schema.add("calibration.blocks", &config.blocks, 4U, 1000U, "",
             "blocks of the log that the bootstrap draws from; more for logs of hours, but each "
             "block must be long enough to be independent of the next");
  schema.add("calibration.resamples", &config.resamples, 2U, 100'000U, "",
             "refits of the bootstrap that give the spread of each value; more: a steadier spread "
             "at a proportional cost");
  schema.fix({"calibration.blocks", "calibration.resamples"});
}

}  // namespace topogeo::localization
