// Settings of the thesis's own algorithm.
#pragma once

#include <cstdint>

#include "topogeo/slam/backward_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// Settings that only the thesis's algorithm reads.
struct ThesisConfig {
  std::uint32_t matches = 8;
  std::uint32_t cycle_solutions = 40;
  std::uint32_t alternations = 3;
  std::uint32_t kept_solutions = 0;  ///< 0: the best one at once becomes the trajectory
  std::uint32_t cycle_candidates = 12;
  BackwardConfig backward;
};

/// Declares the sections `thesis` and `backward`.
void describe(ThesisConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
