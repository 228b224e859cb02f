#include <algorithm>
#include <set>
#include <utility>

#include "topogeo/exchange/geojson.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "graph_checks.hpp"
#include "json_reader.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

Eigen::Vector2d geojson_position(const JsonValue& value) {
  const std::vector<double> numbers = value.numbers();
  if (numbers.size() < 2) value.fail("[x, y]");
  return {numbers[0], numbers[1]};
}

/// The geometry in a collection of one.
JsonValue geometry_in(const JsonValue& feature) {
  const JsonValue geometries = feature.required("geometry").required("geometries");
  const std::vector<JsonValue> items = geometries.items();
  if (items.size() != 1) geometries.fail("one geometry");
  return items.front().required("coordinates");
}

class GeojsonReader {
 public:
  MapGraph read(const JsonValue& top, const std::string& name) {
    own_ = top.at("topogeo").is_object();
    if (own_) graph_.map.version = top.at("topogeo").required("map_version").whole();
    for (const JsonValue& feature : top.required("features").items()) add(feature);
    if (!own_) add_foreign_branches(name);
    settle(graph_, name);
    return std::move(graph_);
  }

 private:
  void add(const JsonValue& feature) {
    const JsonValue geometry = feature.required("geometry");
    const std::string type = geometry.required("type").text();
    const JsonValue properties = feature.at("properties");
    const std::string word = properties.is_object() && properties.at("topogeo").exists()
                                 ? properties.at("topogeo").text()
                                 : "";
    if (type == "Point") {
      add_node(properties, geojson_position(geometry.required("coordinates")));
    } else if (type == "LineString" || type == "MultiLineString") {
      if (!own_) add_edge(properties);
    } else if (word == "branch") {
      add_branch(properties, geometry_in(feature));
    } else if (word == "place") {
      planning::Place& place = graph_.drawing.places.emplace_back();
      place.name = properties.required("name").text();
      place.position_m = geojson_position(geometry_in(feature));
      if (const JsonValue heading = properties.at("station_heading"); heading.exists()) {
        place.station_heading_rad = heading.number();
      }
    } else if (type == "Polygon") {
      add_zone(properties, geometry.required("coordinates"));
    } else {
      graph_.notes.push_back(fmt::format("{}: geometry {} left out", feature.where(), type));
    }
  }

  void add_node(const JsonValue& properties, const Eigen::Vector2d& position_m) {
    topomap::MapNode node;
    node.id = properties.required("id").id();
    node.position_m = position_m;
    const JsonValue metadata = properties.at("metadata");
    if (metadata.is_object()) {
      const JsonValue kind = metadata.at("kind");
      const auto known = kind.is_text() ? topomap::node_kind_of(kind.text()) : std::nullopt;
      // Bends and places are nodes of the file only.
      if (own_ && !known) return;
      if (known) node.kind = *known;
      if (own_) {
        node.id = metadata.required("node").id();
        node.clearance_m = metadata.required("clearance").number();
        node.observations = metadata.required("observations").id();
        node.last_seen_ns = last_seen(metadata);
      }
      if (!own_ && metadata.at("name").is_text()) {
        graph_.drawing.places.push_back({metadata.at("name").text(), position_m});
      }
    }
    graph_.map.nodes.push_back(node);
  }

  /// Older files do not have it.
  static std::int64_t last_seen(const JsonValue& properties) {
    const JsonValue text = properties.at("last_seen");
    if (!text.is_text()) return 0;
    const auto stamp_ns = stamp_of(text.text());
    if (!stamp_ns) text.fail("seconds with nine digits");
    return *stamp_ns;
  }

  void add_branch(const JsonValue& properties, const JsonValue& points) {
    topomap::MapBranch branch;
    branch.id = properties.required("id").id();
    branch.node_a = properties.required("node_a").id();
    branch.node_b = properties.required("node_b").id();
    branch.is_virtual = properties.required("virtual").boolean_or(false);
    branch.observations = properties.required("observations").id();
    branch.last_seen_ns = last_seen(properties);
    const std::vector<double> clearances = properties.required("clearances").numbers();
    for (const JsonValue& point : points.items()) {
      const std::size_t i = branch.points.size();
      if (i >= clearances.size()) points.fail("as many points as clearances");
      branch.points.push_back({geojson_position(point), clearances[i]});
    }
    if (branch.points.size() < 2 || branch.points.size() != clearances.size()) {
      points.fail("as many points as clearances, at least two");
    }
    graph_.map.branches.push_back(std::move(branch));
  }

  void add_zone(const JsonValue& properties, const JsonValue& rings) {
    const std::vector<JsonValue> items = rings.items();
    if (items.empty()) rings.fail("a ring");
    if (items.size() > 1) {
      graph_.notes.push_back(fmt::format("{}: holes are left out", rings.where()));
    }
    planning::DrawnZone zone;
    zone.name =
        properties.at("name").text_or(fmt::format("zone {}", graph_.drawing.zones.size() + 1));
    // Unknown kinds of foreign files become rooms.
    const JsonValue kind = properties.at("kind");
    if (kind.is_text()) {
      zone.kind = planning::zone_kind_of(kind.text()).value_or(planning::ZoneKind::kRoom);
    }
    if (zone.kind != planning::ZoneKind::kRoom) zone.value = properties.at("value").number_or(0.0);
    for (const JsonValue& corner : items.front().items()) {
      zone.polygon_m.push_back(geojson_position(corner));
    }
    if (zone.polygon_m.size() > 1 && zone.polygon_m.front() == zone.polygon_m.back()) {
      zone.polygon_m.pop_back();
    }
    graph_.drawing.zones.push_back(std::move(zone));
  }

  void add_edge(const JsonValue& properties) {
    const std::uint32_t start = properties.required("startid").id();
    const std::uint32_t end = properties.required("endid").id();
    static_cast<void>(properties.required("id").id());
    if (start == end) {
      graph_.notes.push_back(
          fmt::format("{}: from a node to itself, left out", properties.where()));
      return;
    }
    edges_.insert({std::min(start, end), std::max(start, end)});
  }

  void add_foreign_branches(const std::string& name) {
    settle(graph_, name);
    for (const auto& [a, b] : edges_) {
      topomap::MapBranch branch;
      branch.id = static_cast<std::uint32_t>(graph_.map.branches.size() + 1);
      branch.node_a = a;
      branch.node_b = b;
      for (const std::uint32_t id : {a, b}) {
        const auto node = std::ranges::lower_bound(graph_.map.nodes, id, {}, &topomap::MapNode::id);
        if (node == graph_.map.nodes.end() || node->id != id) continue;  // settle() names it
        branch.points.push_back({node->position_m, 0.0});
      }
      graph_.map.branches.push_back(std::move(branch));
    }
    if (!edges_.empty()) {
      graph_.notes.push_back(
          fmt::format("{} branches are straight, two-way and without clearance: the file has none",
                      edges_.size()));
    }
  }

  bool own_ = false;  // geojson_text wrote the file
  MapGraph graph_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;  // ascending pairs of node ids
};

}  // namespace

MapGraph parse_geojson(std::string_view text, const std::string& name) {
  const nlohmann::ordered_json json = parse_json(text, name);
  return GeojsonReader().read(JsonValue(&json, name + ':'), name);
}

}  // namespace topogeo::exchange
