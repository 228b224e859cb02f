// The whole global map as GraphML, an XML form of graphs that NetworkX, yEd and Gephi read
// (docs/exchange.md, "GraphML"): a node for each node and place, an undirected edge for each
// branch.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

std::string graphml_text(const topomap::GlobalMap& map, std::span<const planning::Place> places);

/// Reads the output of graphml_text without loss. Foreign files need `x` and `y` at each node;
/// their edges without `points` become straight branches. Throws std::runtime_error naming the
/// file, the element and the expectation.
MapGraph parse_graphml(std::string_view text, const std::string& name);

}  // namespace topogeo::exchange
