// Settings of the thesis's own algorithm.
#pragma once

#include <cstdint>

#include "topogeo/localization/thesis/backward_config.hpp"

namespace topogeo::localization {

/// What only the thesis's algorithm asks for; the reasons stand beside the numbers.
struct ThesisConfig {
  std::uint32_t matches = 8;  ///< of a new map with those that it overlaps with, best first: more
                              ///< of them hardly ever hold the fittest match
  std::uint32_t cycle_solutions = 40;  ///< per map seen again, as in the thesis
  std::uint32_t alternations = 3;      ///< of forward and backward in one step, at most
  BackwardConfig backward;
};

}  // namespace topogeo::localization
