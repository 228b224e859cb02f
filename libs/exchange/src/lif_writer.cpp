#include <algorithm>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "topogeo/exchange/lif.hpp"
#include "topogeo/exchange/place_graph.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/node_kind_name.hpp"

#include "json_reader.hpp"
#include "segments.hpp"
#include "text.hpp"

namespace topogeo::exchange {
namespace {

using Json = nlohmann::ordered_json;

class LifWriter {
 public:
  LifWriter(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
            const NetworkSettings& settings, const ExportHeader& header)
      : map_(map),
        drawing_(drawing),
        settings_(settings),
        header_(header),
        vehicle_(plain_id("topogeo." + header.robot_id)),
        joining_(joining_virtual_branches(map)) {}

  LifText write() {
    Json layout = {{"layoutId", plain_id(header_.level)},
                   {"layoutName", header_.level},
                   {"layoutVersion", std::to_string(std::max<std::uint64_t>(map_.version, 1))},
                   {"nodes", Json::array()},
                   {"edges", Json::array()},
                   {"stations", Json::array()}};
    for (const topomap::MapNode& node : map_.nodes) layout["nodes"].push_back(node_of(node));
    for (const topomap::MapBranch& branch : map_.branches) add_edges(branch, layout["edges"]);
    for (const planning::Place& place : drawing_.places) add_station(place, layout["stations"]);
    if (left_out_ > 0) {
      out_.notes.push_back(fmt::format(
          "{} branches left out: virtual, back to their own node, narrower than the robot ({:g} m "
          "on each side) or forbidden by zones",
          left_out_, settings_.robot_radius_m));
    }
    const Json top = {{"metaInformation",
                       {{"projectIdentification", header_.map_id},
                        {"creator", header_.manufacturer},
                        {"exportTimestamp", utc_text(header_.stamp_ns)},
                        {"lifVersion", "1.0.0"}}},
                      {"layouts", Json::array({std::move(layout)})}};
    out_.text = top.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
    return std::move(out_);
  }

 private:
  [[nodiscard]] Json node_of(const topomap::MapNode& node) const {
    return {{"nodeId", fmt::format("n{}", node.id)},
            {"nodeDescription", name_of(node.kind)},
            {"mapId", plain_id(header_.map_id)},
            {"nodePosition", {{"x", node.position_m.x()}, {"y", node.position_m.y()}}},
            {"vehicleTypeNodeProperties", Json::array({{{"vehicleTypeId", vehicle_}}})}};
  }

  void add_edges(const topomap::MapBranch& branch, Json& edges) {
    double narrowest_m = std::numeric_limits<double>::infinity();
    DrivingRule rule;
    for (std::size_t i = 0; i < branch.points.size(); ++i) {
      narrowest_m = std::min(narrowest_m, branch.points[i].clearance_m);
      if (i == 0) continue;
      rule.add(rule_between(drawing_.zones, branch.points[i - 1].position_m,
                            branch.points[i].position_m));
    }
    const bool narrow = narrowest_m < settings_.robot_radius_m && !lacks_clearance(branch);
    const bool unseen =
        branch.is_virtual && !settings_.with_virtual && !joining_.contains(branch.id);
    if (rule.forbidden() || narrow || unseen || branch.node_a == branch.node_b) {
      ++left_out_;
      return;
    }
    for (const std::uint32_t id : {branch.node_a, branch.node_b}) joined_.insert(id);
    if (rule.forward) edges.push_back(edge_of(branch, true, rule));
    if (rule.backward) edges.push_back(edge_of(branch, false, rule));
  }

  [[nodiscard]] Json edge_of(const topomap::MapBranch& branch, bool forward,
                             const DrivingRule& rule) const {
    Json properties = {{"vehicleTypeId", vehicle_},
                       {"vehicleOrientation", 0.0},
                       {"rotationAllowed", true},
                       {"trajectory", trajectory_of(branch, forward)}};
    if (rule.speed_mps) properties["maxSpeed"] = *rule.speed_mps;
    return {{"edgeId", fmt::format("b{}{}", branch.id, forward ? '+' : '-')},
            {"startNodeId", fmt::format("n{}", forward ? branch.node_a : branch.node_b)},
            {"endNodeId", fmt::format("n{}", forward ? branch.node_b : branch.node_a)},
            {"vehicleTypeEdgeProperties", Json::array({std::move(properties)})}};
  }

  /// A NURBS of degree 1 is the polyline of its control points.
  static Json trajectory_of(const topomap::MapBranch& branch, bool forward) {
    Json points = Json::array();
    for (const topomap::BranchPoint& p : branch.points) {
      points.push_back({{"x", p.position_m.x()}, {"y", p.position_m.y()}});
    }
    if (!forward) std::ranges::reverse(points);
    const std::size_t steps = branch.points.size() - 1;
    Json knots = Json::array({0.0});
    for (std::size_t i = 0; i <= steps; ++i) {
      knots.push_back(static_cast<double>(i) / static_cast<double>(steps));
    }
    knots.push_back(1.0);
    return {{"degree", 1}, {"knotVector", std::move(knots)}, {"controlPoints", std::move(points)}};
  }

  void add_station(const planning::Place& place, Json& stations) {
    const topomap::MapNode* nearest = nullptr;
    for (const topomap::MapNode& node : map_.nodes) {
      if (!joined_.contains(node.id)) continue;
      if (nearest == nullptr || distance(node.position_m, place.position_m) <
                                    distance(nearest->position_m, place.position_m)) {
        nearest = &node;
      }
    }
    if (nearest == nullptr) {
      out_.notes.push_back(fmt::format("place '{}' left out: no node has an edge", place.name));
      return;
    }
    const double heading_rad = place.station_heading_rad.value_or(0.0);
    Json station = {
        {"stationId", fmt::format("s{}", stations.size() + 1)},
        {"stationName", place.name},
        {"interactionNodeIds", Json::array({fmt::format("n{}", nearest->id)})},
        {"stationPosition",
         {{"x", place.position_m.x()}, {"y", place.position_m.y()}, {"theta", heading_rad}}}};
    if (place.station_heading_rad) station["stationDescription"] = kBaseStation;
    stations.push_back(std::move(station));
  }

  const topomap::GlobalMap& map_;
  const storage::MapDrawing& drawing_;
  NetworkSettings settings_;
  const ExportHeader& header_;
  std::string vehicle_;
  std::set<std::uint32_t> joining_;  // virtual branches that are kept
  LifText out_;
  std::set<std::uint32_t> joined_;  // ids of nodes that have an edge
  std::size_t left_out_ = 0;
};

}  // namespace

LifText lif_text(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                 const NetworkSettings& settings, const ExportHeader& header) {
  return LifWriter(map, drawing, settings, header).write();
}

}  // namespace topogeo::exchange
