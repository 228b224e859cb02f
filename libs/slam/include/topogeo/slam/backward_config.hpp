// Settings of the backward correction of the thesis.
#pragma once

#include <cstdint>

#include "topogeo/slam/loop/loop_config.hpp"

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

/// The resolutions are also the grid spacing of the poses that are tried if nothing overlaps.
struct BackwardConfig : LoopSearchConfig {
  std::uint32_t largest_grid = 125;
  std::uint32_t intermediate_steps = 9;
  friend bool operator==(const BackwardConfig&, const BackwardConfig&) = default;
};

/// Declares the section `backward`, without the resolutions, which are those of `match`.
void describe(BackwardConfig& config, support::ConfigSchema& schema);

}  // namespace topogeo::localization
