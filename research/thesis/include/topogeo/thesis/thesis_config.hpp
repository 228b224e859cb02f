// Settings of the thesis's own algorithm.
#pragma once

#include <cstdint>

#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// Settings of the backward correction. The resolutions are also the grid spacing of the poses that
/// are tried if nothing overlaps.
struct BackwardConfig : LoopSearchConfig {
  std::uint32_t largest_grid = 125;
  std::uint32_t intermediate_steps = 9;
  friend bool operator==(const BackwardConfig&, const BackwardConfig&) = default;
};

/// Settings that only the thesis's algorithm reads.
struct ThesisConfig {
  std::uint32_t matches = 8;
  std::uint32_t cycle_solutions = 40;
  std::uint32_t alternations = 3;
  std::uint32_t kept_solutions = 0;  ///< 0: the best one at once becomes the trajectory
  std::uint32_t cycle_candidates = 12;
  BackwardConfig backward;
};

/// All settings of a run in mode thesis.
struct ThesisSlamConfig : LocalizerConfig {
  ThesisConfig thesis;
};

/// Declares the section `backward`, without the resolutions, which are those of `match`.
void describe(BackwardConfig& config, support::ConfigSchema& schema);
/// Declares the sections `thesis` and `backward`.
void describe(ThesisConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
