#include "topogeo/exchange/geojson.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "json_reader.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

using Json = nlohmann::ordered_json;

// Nodes of the map with larger ids get new ones: Nav2 takes 2147483647 for a deleted node, and
// bends and edges need ids above all nodes.
constexpr std::uint32_t kFirstReplaced = 1'000'000'000;

Json coordinates(const Eigen::Vector2d& position_m) {
  return Json::array({position_m.x(), position_m.y()});
}

Json geojson_feature(Json properties, Json geometry) {
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry", std::move(geometry)}};
}

/// A geometry that Nav2 takes for neither node nor edge.
Json collection_of(Json geometry) {
  return {{"type", "GeometryCollection"}, {"geometries", Json::array({std::move(geometry)})}};
}

/// Round numbers, so that people recognize the kind of an id at once.
std::uint64_t next_range(std::uint64_t used) {
  constexpr std::uint64_t kRange = 100'000;
  return (used / kRange + 1) * kRange;
}

class GeojsonWriter {
 public:
  GeojsonWriter(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                const RouteNetwork& network)
      : map_(map), drawing_(drawing), network_(network) {
    std::uint64_t last = 0;
    for (const topomap::MapNode& node : map.nodes) {
      if (node.id < kFirstReplaced) last = node.id;
    }
    std::uint64_t next = next_range(last);
    for (const NetworkNode& node : network.nodes) {
      const bool keeps = node.map_node && map.nodes[*node.map_node].id < kFirstReplaced;
      ids_.push_back(keeps ? map.nodes[*node.map_node].id : next++);
    }
    first_edge_ = next_range(next);
  }

  std::string text() {
    Json top = {{"type", "FeatureCollection"},
                {"name", "topogeo"},
                {"topogeo", {{"version", 1}, {"map_version", map_.version}}},
                {"features", Json::array()}};
    for (std::size_t i = 0; i < network_.nodes.size(); ++i) top["features"].push_back(node(i));
    std::uint64_t id = first_edge_;
    for (const NetworkPiece& piece : network_.pieces) {
      if (piece.rule.forward) top["features"].push_back(edge(piece, id, true));
      if (piece.rule.backward) top["features"].push_back(edge(piece, id + 1, false));
      id += 2;
    }
    for (const topomap::MapBranch& branch : map_.branches) {
      top["features"].push_back(whole_branch(branch));
    }
    for (const planning::Place& place : drawing_.places) {
      Json properties = {{"topogeo", "place"}, {"name", place.name}};
      if (place.station_heading_rad) properties["station_heading"] = *place.station_heading_rad;
      top["features"].push_back(geojson_feature(
          std::move(properties),
          collection_of({{"type", "Point"}, {"coordinates", coordinates(place.position_m)}})));
    }
    for (const planning::DrawnZone& zone : drawing_.zones) {
      top["features"].push_back(zone_feature(zone));
    }
    return json_text(top);
  }

 private:
  [[nodiscard]] Json node(std::size_t index) const {
    const NetworkNode& in = network_.nodes[index];
    Json metadata = {{"kind", "bend"}, {"clearance", in.clearance_m}};
    if (in.place) metadata["kind"] = "place";
    if (in.map_node) {
      const topomap::MapNode& of_map = map_.nodes[*in.map_node];
      metadata["kind"] = name_of(of_map.kind);
      metadata["node"] = of_map.id;
      metadata["observations"] = of_map.observations;
      if (of_map.last_seen_ns != 0) metadata["last_seen"] = seconds_text(of_map.last_seen_ns);
    }
    if (in.place) {
      const planning::Place& place = drawing_.places[*in.place];
      metadata["name"] = place.name;
      if (place.station_heading_rad) metadata["station_heading"] = *place.station_heading_rad;
    }
    return geojson_feature(
        {{"id", ids_[index]}, {"frame", "map"}, {"metadata", std::move(metadata)}},
        {{"type", "Point"}, {"coordinates", coordinates(in.position_m)}});
  }

  [[nodiscard]] Json edge(const NetworkPiece& piece, std::uint64_t id, bool forward) const {
    const std::uint32_t from = forward ? piece.from : piece.to;
    const std::uint32_t to = forward ? piece.to : piece.from;
    Json metadata = {{"clearance", piece.clearance_m}};
    if (piece.branch) metadata["branch"] = *piece.branch;
    // Read by TimeScorer, which otherwise assumes the robot's full speed.
    if (piece.rule.speed_mps) metadata["abs_speed_limit"] = *piece.rule.speed_mps;
    return geojson_feature({{"id", id},
                            {"startid", ids_[from]},
                            {"endid", ids_[to]},
                            {"metadata", std::move(metadata)}},
                           {{"type", "LineString"},
                            {"coordinates",
                             {coordinates(network_.nodes[from].position_m),
                              coordinates(network_.nodes[to].position_m)}}});
  }

  static Json whole_branch(const topomap::MapBranch& branch) {
    Json points = Json::array();
    Json clearances = Json::array();
    for (const topomap::BranchPoint& p : branch.points) {
      points.push_back(coordinates(p.position_m));
      clearances.push_back(p.clearance_m);
    }
    Json properties = {{"topogeo", "branch"},
                       {"id", branch.id},
                       {"node_a", branch.node_a},
                       {"node_b", branch.node_b},
                       {"virtual", branch.is_virtual},
                       {"observations", branch.observations},
                       {"clearances", std::move(clearances)}};
    if (branch.last_seen_ns != 0) properties["last_seen"] = seconds_text(branch.last_seen_ns);
    return geojson_feature(
        std::move(properties),
        collection_of({{"type", "LineString"}, {"coordinates", std::move(points)}}));
  }

  static Json zone_feature(const planning::DrawnZone& zone) {
    // The first corner is repeated to close the ring (GeoJSON, RFC 7946, 3.1.6).
    Json ring = Json::array();
    for (const Eigen::Vector2d& corner : zone.polygon_m) ring.push_back(coordinates(corner));
    ring.push_back(ring.front());
    return geojson_feature({{"topogeo", "zone"},
                            {"name", zone.name},
                            {"kind", planning::to_string(zone.kind)},
                            {"value", zone.value}},
                           {{"type", "Polygon"}, {"coordinates", Json::array({std::move(ring)})}});
  }

  const topomap::GlobalMap& map_;
  const storage::MapDrawing& drawing_;
  const RouteNetwork& network_;
  std::vector<std::uint64_t> ids_;  // in the file, for each node of the network
  std::uint64_t first_edge_ = 0;
};

}  // namespace

std::string geojson_text(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                         const RouteNetwork& network) {
  return GeojsonWriter(map, drawing, network).text();
}

}  // namespace topogeo::exchange
