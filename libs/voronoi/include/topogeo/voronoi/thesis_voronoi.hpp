// Settings for the figures of the Thesis, chapter 4.
#pragma once

#include "topogeo/voronoi/voronoi_config.hpp"

namespace topogeo::voronoi {

/// The rules of the Thesis with its range limit and its cells. The Thesis prints no thresholds: 0.3
/// m splits the objects in its figures, and 0.55 m is just over the width of its robot.
VoronoiConfig thesis_voronoi();
/// The same without the rules after the split at discontinuities (steps 2 to 5).
VoronoiConfig thesis_splitting_alone();

}  // namespace topogeo::voronoi
