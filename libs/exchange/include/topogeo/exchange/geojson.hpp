// The map as GeoJSON, as the route server of Nav2 reads it (docs/exchange.md, "GeoJSON").
//
// Point features are nodes, LineString features directed edges. What Nav2 has no word for stands in
// features of other kinds, which it leaves out: a GeometryCollection for each whole branch and
// place, a Polygon for each zone. From these the map is read back without loss.
#pragma once

#include <string>
#include <string_view>

#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

/// `network` is that of the map and of the drawing's places. Numbers are of the map frame, which
/// Nav2 calls "map". Nodes keep their ids, but those from 1e9 on, which Nav2 keeps for itself.
std::string geojson_text(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                         const RouteNetwork& network);

/// Reads what geojson_text wrote without loss. In files of others each pair of nodes with an edge
/// is a straight branch without clearance; `name` stands for the file in messages. Throws
/// std::runtime_error naming the file, the feature and what was expected.
MapGraph parse_geojson(std::string_view text, const std::string& name);

}  // namespace topogeo::exchange
