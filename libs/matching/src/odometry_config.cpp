#include "topogeo/matching/match_config.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::localization {

void describe(OdometryNoise& noise, support::ConfigSchema& schema) {
  constexpr double kLeast = kSmallestOdometryNoise;
  constexpr double kMost = kLargestOdometryNoise;
  schema.add("odometry.translation_m2_per_m", &noise.translation_m2_per_m, kLeast, kMost, "m2/m",
             "variance along the motion per metre travelled");
  schema.add("odometry.lateral_m2_per_m", &noise.lateral_m2_per_m, kLeast, kMost, "m2/m",
             "variance across the motion per metre travelled");
  schema.add("odometry.translation_m2_per_rad", &noise.translation_m2_per_rad, 0.0, kMost, "m2/rad",
             "variance of the position per radian of turn");
  schema.add("odometry.heading_rad2_per_m", &noise.heading_rad2_per_m, kLeast, kMost, "rad2/m",
             "variance of the heading per metre travelled; generous, because too small a value is "
             "the worst mistake");
  schema.add("odometry.heading_rad2_per_rad", &noise.heading_rad2_per_rad, kLeast, kMost,
             "rad2/rad", "variance of the heading per radian of turn");
}

}  // namespace topogeo::localization
