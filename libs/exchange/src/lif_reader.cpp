#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "topogeo/exchange/lif.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "graph_checks.hpp"
#include "json_reader.hpp"
#include "nurbs.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

Eigen::Vector2d lif_position(const JsonValue& value) {
  return {value.required("x").number(), value.required("y").number()};
}

/// The value under its name of 1.0, or under that of 2.0.
JsonValue either(const JsonValue& object, const char* first, const char* second) {
  const JsonValue value = object.at(first);
  return value.exists() ? value : object.at(second);
}

/// The number of "n17" in our own files.
std::optional<std::uint32_t> lif_number(std::string_view id, char letter) {
  if (id.size() < 2 || id.front() != letter) return std::nullopt;
  const auto number = whole_number_of(id.substr(1));
  if (!number || *number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(*number);
}

class LifReader {
 public:
  MapGraph read(const JsonValue& top, const std::string& name) {
    const JsonValue layout = first_layout(top);
    read_nodes(layout.required("nodes"));
    for (const JsonValue& edge : layout.required("edges").items()) add_edge(edge);
    add_notes();
    if (layout.at("stations").exists()) {
      for (const JsonValue& station : layout.at("stations").items()) add_station(station);
    }
    settle(graph_, name);
    return std::move(graph_);
  }

 private:
  void add_notes() {
    if (!graph_.map.branches.empty()) {
      graph_.notes.push_back("LIF holds no clearance: branches get 0");
    }
    const auto one_way = std::ranges::count_if(directions_, [&](const auto& ends) {
      return !directions_.contains({ends.second, ends.first});
    });
    if (one_way > 0) {
      graph_.notes.push_back(
          fmt::format("{} edges lead one way only, their branches both ways: a one-way zone of the "
                      "map keeps the direction",
                      one_way));
    }
    if (elsewhere_ > 0) {
      graph_.notes.push_back(
          fmt::format("{} edges lead to a node that this layout lacks, left out", elsewhere_));
    }
  }

  /// In 2.0 the layouts are inside origins.
  JsonValue first_layout(const JsonValue& top) {
    const JsonValue holder =
        top.at("layouts").exists() ? top : first_of(top.required("origins"), "origins");
    return first_of(holder.required("layouts"), "layouts");
  }
  JsonValue first_of(const JsonValue& list, const char* what) {
    const std::vector<JsonValue> items = list.items();
    if (items.empty()) list.fail("at least one entry");
    if (items.size() > 1) {
      graph_.notes.push_back(fmt::format("only the first of {} {} is read", items.size(), what));
    }
    return items.front();
  }

  void read_nodes(const JsonValue& nodes) {
    const std::vector<JsonValue> items = nodes.items();
    const bool own = std::ranges::all_of(items, [](const JsonValue& node) {
      return lif_number(node.required("nodeId").text(), 'n').has_value();
    });
    for (const JsonValue& item : items) {
      const JsonValue id = item.required("nodeId");
      topomap::MapNode node;
      node.id = own ? *lif_number(id.text(), 'n')
                    : static_cast<std::uint32_t>(graph_.map.nodes.size() + 1);
      node.position_m = lif_position(item.required("nodePosition"));
      node.kind =
          topomap::node_kind_of(either(item, "nodeDescription", "nodeDescriptor").text_or(""))
              .value_or(node.kind);
      if (!nodes_.emplace(id.text(), node).second) id.fail("each nodeId once");
      graph_.map.nodes.push_back(node);
    }
  }

  [[nodiscard]] const topomap::MapNode& node_of(const JsonValue& id) const {
    const auto found = nodes_.find(id.text());
    if (found == nodes_.end()) id.fail("the nodeId of a node of this layout");
    return found->second;
  }

  void add_edge(const JsonValue& edge) {
    const std::string id = edge.required("edgeId").text();
    const topomap::MapNode& start = node_of(edge.required("startNodeId"));
    // An edge to another layout, for example on a lift.
    if (!nodes_.contains(edge.required("endNodeId").text())) {
      ++elsewhere_;
      return;
    }
    const topomap::MapNode& end = node_of(edge.at("endNodeId"));
    std::vector<Eigen::Vector2d> way =
        trajectory(either(edge, "vehicleTypeEdgeProperties", "mobileRobotTypeEdgeProperties"));
    directions_.insert({start.id, end.id});
    if (way.empty()) way = {start.position_m, end.position_m};
    const bool backward = id.ends_with('-');
    const bool signed_id = backward || id.ends_with('+');
    const auto own = signed_id ? lif_number(id.substr(0, id.size() - 1), 'b') : std::nullopt;
    // The opposite direction of an existing branch.
    std::pair<std::uint32_t, std::uint32_t> ends{end.id, start.id};
    if (own ? !branch_ids_.insert(*own).second : !own && straight_.contains(ends)) return;
    straight_.insert({start.id, end.id});
    topomap::MapBranch branch;
    branch.id = own.value_or(static_cast<std::uint32_t>(graph_.map.branches.size() + 1));
    branch.node_a = start.id;
    branch.node_b = end.id;
    if (backward && own) {
      std::swap(branch.node_a, branch.node_b);
      std::ranges::reverse(way);
    }
    for (const Eigen::Vector2d& point : way) branch.points.push_back({point, 0.0});
    graph_.map.branches.push_back(std::move(branch));
  }

  /// The trajectory of the first vehicle type that has one.
  std::vector<Eigen::Vector2d> trajectory(const JsonValue& properties) {
    if (!properties.exists()) return {};
    for (const JsonValue& of_type : properties.items()) {
      const JsonValue curve = of_type.at("trajectory");
      if (!curve.exists()) continue;
      Nurbs nurbs;
      const double degree = curve.at("degree").number_or(1.0);
      if (degree < 1.0 || degree > 10.0 || degree != static_cast<int>(degree)) {
        curve.at("degree").fail("a whole number from 1 to 10");
      }
      nurbs.degree = static_cast<std::size_t>(degree);
      nurbs.knots = curve.required("knotVector").numbers();
      for (const JsonValue& point : curve.required("controlPoints").items()) {
        nurbs.points.push_back(lif_position(point));
        nurbs.weights.push_back(point.at("weight").number_or(1.0));
      }
      const std::string fault = nurbs.fault();
      if (!fault.empty()) curve.fail(fault);
      return nurbs.polyline();
    }
    return {};
  }

  void add_station(const JsonValue& station) {
    const std::string id = station.required("stationId").text();
    const std::string name = station.at("stationName").text_or(id);
    const JsonValue position = station.at("stationPosition");
    const std::vector<JsonValue> nodes = station.required("interactionNodeIds").items();
    if (nodes.empty()) station.at("interactionNodeIds").fail("at least one node");
    const Eigen::Vector2d at_m =
        position.exists() ? lif_position(position) : node_of(nodes.front()).position_m;
    if (graph_.drawing.places.size() == storage::kMaxPlaces) {
      station.fail(fmt::format("at most {} stations", storage::kMaxPlaces));
    }
    const bool taken = std::ranges::find(graph_.drawing.places, name, &planning::Place::name) !=
                       graph_.drawing.places.end();
    planning::Place& place = graph_.drawing.places.emplace_back();
    place.name = taken ? id : name;
    place.position_m = at_m;
    // Foreign stations also have a direction, that of the work there.
    if (either(station, "stationDescription", "stationDescriptor").text_or("") == kBaseStation) {
      place.station_heading_rad = position.required("theta").number();
    }
  }

  MapGraph graph_;
  std::map<std::string, topomap::MapNode> nodes_;
  std::set<std::uint32_t> branch_ids_;
  std::set<std::pair<std::uint32_t, std::uint32_t>> straight_;    // ends of branches
  std::set<std::pair<std::uint32_t, std::uint32_t>> directions_;  // start and end of all edges
  std::size_t elsewhere_ = 0;                                     // edges to other layouts
};

}  // namespace

MapGraph parse_lif(std::string_view text, const std::string& name) {
  const nlohmann::ordered_json json = parse_json(text, name);
  return LifReader().read(JsonValue(&json, name + ':'), name);
}

}  // namespace topogeo::exchange
