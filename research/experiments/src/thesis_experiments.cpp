#include "topogeo/experiments/thesis_experiments.hpp"

namespace topogeo::simulation {

SimulationOptions thesis_experiment_1(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.odometry.range_scale_error = 0.01;
  options.odometry.heading_drift_rad_per_m = 0.0035;
  options.odometry.heading_sigma_rad_per_sqrt_m = 0.002;
  return options;
}

SimulationOptions thesis_experiment_2(std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.odometry.range_scale_error = 0.02;
  options.odometry.heading_drift_rad_per_m = 0.0005;
  options.odometry.heading_sigma_rad_per_sqrt_m = 0.002;
  options.odometry.turn_scale_error = -0.08;
  return options;
}

}  // namespace topogeo::simulation
