// Checks of an imported graph before it becomes a map.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/exchange/map_graph.hpp"

namespace topogeo::exchange {

/// Sorts nodes and branches by id. Throws std::runtime_error "NAME: ..." for repeated ids, for a
/// branch whose end is no node, and for a drawing like storage::check.
void settle(MapGraph& graph, const std::string& name);

/// Takes the repeated first corner from the end of a border. Returns what a border needs and
/// this one lacks: three corners or more, and no edges that cross or touch. Empty for a good one.
std::string settle_border(std::vector<Eigen::Vector2d>& corners);

/// Checks the zones of a foreign file: their borders, speeds and directions. Throws
/// std::runtime_error "NAME: zone '...': expected ...".
void settle_zones(std::span<planning::DrawnZone> zones, const std::string& name);

}  // namespace topogeo::exchange
