// What every graph that was read must hold before it becomes a map.
#pragma once

#include <string>

#include "topogeo/exchange/map_graph.hpp"

namespace topogeo::exchange {

/// Sorts nodes and branches by id. Throws std::runtime_error "NAME: ..." for repeated ids, a branch
/// that ends at no node, and a drawing as storage::check.
void settle(MapGraph& graph, const std::string& name);

}  // namespace topogeo::exchange
