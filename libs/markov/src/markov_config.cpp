#include "topogeo/markov/markov_config.hpp"

#include <stdexcept>

#include "topogeo/markov/belief_grid.hpp"
#include "topogeo/markov/transition.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::markov {
namespace {

void require_odd(std::string_view key, int value) {
  if (value % 2 == 0) support::refuse_value(key, value, "an odd number");
}

void check_bands(const SonarModelConfig& config) {
  if (config.bands.empty()) throw std::invalid_argument("sonar bands: expected one at least");
  double from_m = 0.0;
  for (const ReliabilityBand& band : config.bands) {
    support::require_between("bands.up_to_m", band.up_to_m, from_m, config.max_range_m, "m");
    support::require_between("bands.reliability", band.reliability, 0.0, 1.0, "");
    from_m = band.up_to_m;
  }
}

}  // namespace

void describe(SonarModelConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.max_range_m", &config.max_range_m, 0.5, 20.0, "m",
             "expected and measured readings beyond it count as this");
  schema.add("markov.rays_per_cone", &config.rays_per_cone, 1, 31, "rays",
             "across the cone of a sonar, odd, so that one is the axis");
  schema.add("markov.scale_m", &config.scale_m, 0.001, 10.0, "m",
             "a mean difference of the readings by this much makes a place e times less likely");
  schema.add("markov.difference_cap_m", &config.difference_cap_m, 0.01, 20.0, "m",
             "a larger difference counts as this: one reading of a person must not decide");
}

void describe(MarkovConfig& config, support::ConfigSchema& schema) {
  schema.add("markov.window_cells", &config.window_cells, BeliefGrid::kSmallest,
             BeliefGrid::kLargest, "cells",
             "side of the window of probabilities, odd; MACONDO: 21");
  schema.add("markov.perceptual_weight", &config.perceptual_weight, 0.0, 1.0, "",
             "of readings that are wholly reliable, against the movement; MACONDO: 0.6");
  describe(config.sonar, schema);
}

void check(const SonarModelConfig& config) {
  support::check_ranges(config);
  require_odd("markov.rays_per_cone", config.rays_per_cone);
  check_bands(config);
}

void check(const MarkovConfig& config) {
  support::check_ranges(config);
  require_odd("markov.window_cells", config.window_cells);
  check(config.transition);
  check(config.sonar);
}

}  // namespace topogeo::markov
