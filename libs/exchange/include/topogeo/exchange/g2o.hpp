// The pose graph of a map as g2o text (docs/exchange.md, "g2o").
#pragma once

#include <string>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

/// A vertex for each stop with a pose, with the id of its local map, the first one fixed; an edge
/// with its information for each measurement that the map keeps. Older maps keep none: their edges
/// are the scan tracking between successive stops and the loops, with the information of a usual
/// match, which a comment of the file states.
std::string g2o_text(const storage::MapDocument& document);

}  // namespace topogeo::exchange
