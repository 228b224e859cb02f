// Places an imported graph in a map.
#pragma once

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// Moves everything from its own frame to the frame of the map.
void move(MapGraph& graph, const geometry::Pose2& T_map_graph);

/// Whether no clearance of the branch is known: it is 0 at all points.
bool lacks_clearance(const topomap::MapBranch& branch);

/// Whether a node or a whole branch lacks clearances: the distances of a large grid take seconds.
bool lacks_clearances(const topomap::GlobalMap& map);

/// Fills missing clearances (0 at all points of a branch) from the distances of the grid; 0 remains
/// outside of the grid.
void take_clearances(topomap::GlobalMap& map, const planning::FreeSpace& space);

/// Places and zones replace those of the same name, others are appended. Nodes and branches
/// replace those of a map without stops; beside stops a note reports that they are left out.
void lay_over(storage::MapDocument& document, MapGraph graph, Notes& notes);

}  // namespace topogeo::exchange
