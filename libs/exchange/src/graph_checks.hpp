// Checks of an imported graph before it becomes a map.
#pragma once

#include <string>

#include "topogeo/exchange/map_graph.hpp"

namespace topogeo::exchange {

/// Sorts nodes and branches by id. Throws std::runtime_error "NAME: ..." for repeated ids, for a
/// branch whose end is no node, and for a drawing like storage::check.
void settle(MapGraph& graph, const std::string& name);

}  // namespace topogeo::exchange
