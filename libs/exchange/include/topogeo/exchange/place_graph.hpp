// Puts what was imported where it lies in a map.
#pragma once

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// Everything in it from its own frame to that of the map.
void move(MapGraph& graph, const geometry::Pose2& T_map_graph);

/// Whether a node or a whole branch has none: to know the distances of a large grid takes seconds.
bool lacks_clearances(const topomap::GlobalMap& map);

/// Clearances that a file did not have (0 at all points of a branch), from the distances of the
/// grid; 0 stays where the grid does not reach.
void take_clearances(topomap::GlobalMap& map, const planning::FreeSpace& space);

/// Places and zones take the place of those of the same name, others come behind; nodes and
/// branches are taken when the map has none, else there is a note.
void lay_over(storage::MapDocument& document, MapGraph graph, Notes& notes);

}  // namespace topogeo::exchange
