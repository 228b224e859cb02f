// The settings of the Thesis, chapter 5, for its figures.
#pragma once

#include "topogeo/topomap/local_map_config.hpp"

namespace topogeo::topomap {

/// The Thesis's search for states with thresholds for its figures, and its range limit.
LocalMapConfig thesis_local_map();

}  // namespace topogeo::topomap
