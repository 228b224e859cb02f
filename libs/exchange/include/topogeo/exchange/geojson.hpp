// The map as GeoJSON for the route server of Nav2 (docs/exchange.md, "GeoJSON").
//
// Point features are nodes, LineString features directed edges. Features of other kinds, which Nav2
// skips, hold the rest: a GeometryCollection for each whole branch and place, a Polygon for each
// zone. They let the map be read back without loss.
#pragma once

#include <string>
#include <string_view>

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

/// `network` belongs to the map and to the drawing's places. Coordinates are in the map frame,
/// which Nav2 calls "map". Nodes keep their ids below 1e9; Nav2 reserves some of the higher ones.
std::string geojson_text(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                         const RouteNetwork& network);

/// Reads the output of geojson_text without loss. In foreign files each pair of nodes with an edge
/// becomes a straight branch without clearance; `name` is the file in messages. Throws
/// std::runtime_error naming the file, the feature and the expectation.
MapGraph parse_geojson(std::string_view text, const std::string& name);

}  // namespace topogeo::exchange
