// The map as a navigation graph of Open-RMF (docs/exchange.md, "Open-RMF").
#pragma once

#include <span>
#include <string>

#include "topogeo/exchange/route_network.hpp"
#include "topogeo/planning/zones.hpp"

namespace topogeo::exchange {

/// One level; a vertex for each node of the network, named if it is a place, a lane for each
/// direction of a piece.
std::string rmf_text(const RouteNetwork& network, std::span<const planning::Place> places,
                     const std::string& building, const std::string& level);

}  // namespace topogeo::exchange
