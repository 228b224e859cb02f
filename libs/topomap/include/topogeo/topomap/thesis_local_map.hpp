// Settings for the figures of the Thesis, chapter 5.
#pragma once

#include "topogeo/topomap/local_map_config.hpp"

namespace topogeo::topomap {

/// The Thesis's search for states, with the thresholds and the range limit of its figures.
LocalMapConfig thesis_local_map();

}  // namespace topogeo::topomap
