// The pose graph of a map as g2o text (docs/exchange.md, "g2o").
#pragma once

#include <string>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// A vertex for each stop that has a pose, with the id of its local map, the first of them fixed;
/// an edge for each measurement that the map keeps, with its information. Of a map without them
/// (files of before) edges are those between stops one after another as scan tracking measured
/// them, and the loops, with the information of a usual match, which a comment of the file states.
std::string g2o_text(const storage::MapDocument& document);

}  // namespace topogeo::exchange
