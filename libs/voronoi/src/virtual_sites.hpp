// Virtual groups for a scan of fewer than two groups (Thesis, 4.2.1, fig. 4.7).
#pragma once

#include <span>

#include "topogeo/voronoi/generator_groups.hpp"

namespace topogeo::voronoi {

/// Adds one virtual group (beside one real one) or two (beside none) to `groups`: lines of points
/// parallel to the motion, as far as `free_range_m` of the beam that they lie on. Beside one group
/// the line is on the other side of the robot, at the same distance and as long, so that the
/// branch between them leads straight on, and not nearer than virtual_half_width_m unless the group
/// itself goes round the robot nearer than that. `free_range_m` is cut where the lines stand.
void add_virtual_groups(const BeamDirections& beams, std::span<double> free_range_m,
                        const VoronoiConfig& config, GeneratorGroups& groups);

}  // namespace topogeo::voronoi
