#include <algorithm>
#include <limits>

#include "topogeo/exchange/graphml.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/markup.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "segments.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

constexpr std::string_view kHead = R"(<?xml version="1.0" encoding="UTF-8"?>
<graphml xmlns="http://graphml.graphdrawing.org/xmlns">
<key id="map_version" for="graph" attr.name="map_version" attr.type="long"/>
<key id="x" for="node" attr.name="x" attr.type="double"/>
<key id="y" for="node" attr.name="y" attr.type="double"/>
<key id="kind" for="node" attr.name="kind" attr.type="string"/>
<key id="clearance" for="node" attr.name="clearance" attr.type="double"/>
<key id="seen" for="node" attr.name="observations" attr.type="long"/>
<key id="seen_last" for="node" attr.name="last_seen" attr.type="string"/>
<key id="name" for="node" attr.name="name" attr.type="string"/>
<key id="heading" for="node" attr.name="station_heading" attr.type="double"/>
<key id="virtual" for="edge" attr.name="virtual" attr.type="boolean"/>
<key id="times" for="edge" attr.name="observations" attr.type="long"/>
<key id="last_time" for="edge" attr.name="last_seen" attr.type="string"/>
<key id="length" for="edge" attr.name="length" attr.type="double"/>
<key id="narrowest" for="edge" attr.name="least_clearance" attr.type="double"/>
<key id="points" for="edge" attr.name="points" attr.type="string"/>
<graph id="map" edgedefault="undirected">
)";

std::string datum(std::string_view key, std::string_view text) {
  return fmt::format("<data key=\"{}\">{}</data>", key, text);
}

std::string position(const Eigen::Vector2d& position_m) {
  return datum("x", number_text(position_m.x())) + datum("y", number_text(position_m.y()));
}

std::string edge_text(const topomap::MapBranch& branch) {
  std::string points;
  double length_m = 0.0;
  double narrowest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    const topomap::BranchPoint& p = branch.points[i];
    if (i > 0) length_m += distance(branch.points[i - 1].position_m, p.position_m);
    narrowest_m = std::min(narrowest_m, p.clearance_m);
    for (const double value : {p.position_m.x(), p.position_m.y(), p.clearance_m}) {
      points += (points.empty() ? "" : " ") + number_text(value);
    }
  }
  return fmt::format("<edge id=\"b{}\" source=\"n{}\" target=\"n{}\">", branch.id, branch.node_a,
                     branch.node_b) +
         datum("virtual", branch.is_virtual ? "true" : "false") +
         datum("times", std::to_string(branch.observations)) +
         datum("last_time", seconds_text(branch.last_seen_ns)) +
         datum("length", number_text(length_m)) + datum("narrowest", number_text(narrowest_m)) +
         datum("points", points) + "</edge>\n";
}

}  // namespace

std::string graphml_text(const topomap::GlobalMap& map, std::span<const planning::Place> places) {
  std::string text(kHead);
  text += datum("map_version", std::to_string(map.version)) + '\n';
  for (const topomap::MapNode& node : map.nodes) {
    text += fmt::format("<node id=\"n{}\">", node.id) + position(node.position_m) +
            datum("kind", name_of(node.kind)) + datum("clearance", number_text(node.clearance_m)) +
            datum("seen", std::to_string(node.observations)) +
            datum("seen_last", seconds_text(node.last_seen_ns)) + "</node>\n";
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    text += fmt::format("<node id=\"p{}\">", i) + position(places[i].position_m) +
            datum("kind", "place") + datum("name", support::escaped_markup(places[i].name));
    if (places[i].station_heading_rad) {
      text += datum("heading", number_text(*places[i].station_heading_rad));
    }
    text += "</node>\n";
  }
  for (const topomap::MapBranch& branch : map.branches) text += edge_text(branch);
  return text + "</graph>\n</graphml>\n";
}

}  // namespace topogeo::exchange
