// Settings of the backward correction of the thesis.
#pragma once

#include <cstdint>

#include "topogeo/localization/mapping/loop_search_config.hpp"

namespace topogeo::localization {

/// The resolutions are also the spacing of the grid of poses that are tried where nothing overlaps.
struct BackwardConfig : LoopSearchConfig {
  std::uint32_t largest_grid = 125;  ///< poses of such a grid; a wider space has a wider spacing
  friend bool operator==(const BackwardConfig&, const BackwardConfig&) = default;
};

}  // namespace topogeo::localization
