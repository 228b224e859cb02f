#include "topogeo/localization/matching/odometry_config.hpp"

#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(OdometryNoise& noise, support::ConfigSchema& schema) {
  constexpr double kLeast = kSmallestOdometryNoise;
  constexpr double kMost = kLargestOdometryNoise;
  schema.add("odometry.translation_m2_per_m", &noise.translation_m2_per_m, kLeast, kMost, "m2/m",
             "variance along the motion for each metre of it");
  schema.add("odometry.lateral_m2_per_m", &noise.lateral_m2_per_m, kLeast, kMost, "m2/m",
             "variance across the motion for each metre of it");
  schema.add("odometry.translation_m2_per_rad", &noise.translation_m2_per_rad, 0.0, kMost, "m2/rad",
             "variance of position for each radian of turn");
  schema.add(
      "odometry.heading_rad2_per_m", &noise.heading_rad2_per_m, kLeast, kMost, "rad2/m",
      "variance of heading for each metre; too small is the worst mistake, so it is generous");
  schema.add("odometry.heading_rad2_per_rad", &noise.heading_rad2_per_rad, kLeast, kMost,
             "rad2/rad", "variance of heading for each radian of turn");
}

}  // namespace topogeo::localization
