// The drives of the thesis's experiments (Thesis, 8.2 and 8.3), as far as described: the odometry
// ends with the printed error. The floors are share/thesis/experiment_1.world.yaml and
// experiment_2.world.yaml.
#pragma once

#include <cstdint>

#include "topogeo/simulation/simulate_log.hpp"

namespace topogeo::simulation {

/// A corridor there and back: 1 m and 1.5 degrees off after the first 24 m, mostly to the side, as
/// in 7.3.1.1 (position 11).
SimulationOptions thesis_experiment_1(std::uint64_t seed = 1);

/// A floor with a loop: about 8 m and 17 degrees off after 89 m (position 62). Only the final error
/// is printed, not its growth: here turns are measured 8 % too short.
SimulationOptions thesis_experiment_2(std::uint64_t seed = 1);

}  // namespace topogeo::simulation
