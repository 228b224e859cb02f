#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include "topogeo/exchange/geojson.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "geojson_frame.hpp"
#include "graph_checks.hpp"
#include "json_reader.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

/// The geometry in a collection of one.
JsonValue geometry_in(const JsonValue& feature) {
  const JsonValue geometries = feature.required("geometry").required("geometries");
  const std::vector<JsonValue> items = geometries.items();
  if (items.size() != 1) geometries.fail("one geometry");
  return items.front().required("coordinates");
}

/// The value of a key of properties, which may be null.
JsonValue property(const JsonValue& properties, const std::string& key) {
  return properties.exists() ? properties.at(key) : properties;
}

class GeojsonReader {
 public:
  explicit GeojsonReader(const JsonValue& top) : frame_(top) { graph_.notes = frame_.notes(); }

  MapGraph read(const JsonValue& top, const std::string& name) {
    own_ = top.at("topogeo").is_object();
    if (own_) graph_.map.version = top.at("topogeo").required("map_version").whole();
    const std::vector<JsonValue> features = top.required("features").items();
    if (features.empty()) top.at("features").fail("a feature");
    for (const JsonValue& feature : features) add(feature);
    if (!own_) {
      add_foreign_branches(name);
      settle_zones(graph_.drawing.zones, name);
    }
    settle(graph_, name);
    return std::move(graph_);
  }

 private:
  void add(const JsonValue& feature) {
    const JsonValue geometry = feature.at("geometry");
    if (!geometry.exists()) {
      graph_.notes.push_back(fmt::format("{}: left out, it has no geometry", feature.where()));
      return;
    }
    const std::string type = geometry.required("type").text();
    const JsonValue properties = feature.at("properties");
    const std::string word = properties.is_object() && properties.at("topogeo").exists()
                                 ? properties.at("topogeo").text()
                                 : "";
    if (type == "Point") {
      add_node(properties, frame_.position_m(geometry.required("coordinates")));
    } else if (type == "LineString" || type == "MultiLineString") {
      if (!own_) add_edge(properties);
    } else if (word == "branch") {
      add_branch(properties, geometry_in(feature));
    } else if (word == "place") {
      planning::Place& place = graph_.drawing.places.emplace_back();
      place.name = properties.required("name").text();
      place.position_m = frame_.position_m(geometry_in(feature));
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
        graph_.drawing.places.push_back(
            {new_name(metadata.at("name").text(), place_names_), position_m});
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
      branch.points.push_back({frame_.position_m(point), clearances[i]});
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
    zone.name = property(properties, "name")
                    .text_or(fmt::format("zone {}", graph_.drawing.zones.size() + 1));
    if (!own_) zone.name = new_name(zone.name, zone_names_);
    // Unknown kinds of foreign files become rooms.
    const JsonValue kind = property(properties, "kind");
    if (kind.is_text()) {
      zone.kind = planning::zone_kind_of(kind.text()).value_or(planning::ZoneKind::kRoom);
    }
    if (zone.kind != planning::ZoneKind::kRoom)
      zone.value = property(properties, "value").number_or(0.0);
    for (const JsonValue& corner : items.front().items()) {
      zone.polygon_m.push_back(frame_.position_m(corner));
    }
    if (zone.polygon_m.size() > 1 && zone.polygon_m.front() == zone.polygon_m.back()) {
      zone.polygon_m.pop_back();
    }
    graph_.drawing.zones.push_back(std::move(zone));
  }

  /// Names of the file, and the last number that a repeated one got.
  using TakenNames = std::map<std::string, std::size_t>;

  /// The name, with a number if the file has it twice.
  std::string new_name(const std::string& name, TakenNames& taken) {
    const auto [entry, is_new] = taken.try_emplace(name, 1);
    if (is_new) return name;
    std::string free;
    do {
      free = fmt::format("{} {}", name, ++entry->second);
    } while (!taken.try_emplace(free, 1).second);
    graph_.notes.push_back(fmt::format("a second '{}' is named '{}'", name, free));
    return free;
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

  GeojsonFrame frame_;
  bool own_ = false;  // geojson_text wrote the file
  MapGraph graph_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;  // ascending pairs of node ids
  TakenNames place_names_;
  TakenNames zone_names_;
};

}  // namespace

MapGraph parse_geojson(std::string_view text, const std::string& name) {
  const nlohmann::ordered_json json = parse_json(text, name);
  const JsonValue top(&json, name + ':');
  return GeojsonReader(top).read(top, name);
}

}  // namespace topogeo::exchange
