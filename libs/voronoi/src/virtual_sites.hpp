// Virtual groups for a scan of fewer than two groups (Thesis, 4.2.1, fig. 4.7).
#pragma once

#include <span>

#include "topogeo/voronoi/generator_groups.hpp"

namespace topogeo::voronoi {

/// Adds one virtual group (beside one real one) or two (without any) to `groups`: lines of points
/// parallel to the motion, within `free_range_m` of their beams. Beside one group the line is on
/// the other side of the robot, at the same distance and as long, so that the branch between them
/// leads straight on; it is no nearer than virtual_half_width_m, unless the group itself surrounds
/// the robot more closely. `free_range_m` is cut at the lines.
void add_virtual_groups(const BeamDirections& beams, std::span<double> free_range_m,
                        const VoronoiConfig& config, GeneratorGroups& groups);

}  // namespace topogeo::voronoi
