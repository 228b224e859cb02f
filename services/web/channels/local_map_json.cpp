#include "channels/local_map_json.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "channels/protocol_names.hpp"

namespace topogeo::web {
namespace {

/// Distance below which consecutive outline points are dropped.
constexpr double kOutlineStep_m = 0.08;

/// The outline as a flat list: x and y of each point in turn, in centimetres.
Json outline_json(const topomap::LocalMap& map) {
  constexpr float kCentimetres = 100.0F;
  Json outline = Json::array();
  const topomap::ScanPoint* last = nullptr;
  for (const topomap::ScanPoint& point : map.points) {
    if (last != nullptr &&
        std::hypot(point.x_m - last->x_m, point.y_m - last->y_m) < kOutlineStep_m) {
      continue;
    }
    outline.push_back(std::lround(point.x_m * kCentimetres));
    outline.push_back(std::lround(point.y_m * kCentimetres));
    last = &point;
  }
  return outline;
}

}  // namespace

Json local_map_json(const topomap::LocalMap& map,
                    const std::optional<geometry::Pose2>& T_map_stop) {
  Json nodes = Json::array();
  for (const topomap::LocalNode& node : map.nodes) {
    if (!node.in_main_graph) continue;
    nodes.push_back(Json::array({rounded(node.position_m.x()), rounded(node.position_m.y()),
                                 name_of(static_cast<msg::NodeKind>(node.kind))}));
  }
  Json branches = Json::array();
  for (const topomap::LocalBranch& branch : map.branches) {
    if (!branch.in_main_graph) continue;
    Json points = Json::array();
    for (const topomap::BranchPoint& point : branch.points) {
      points.push_back(rounded(point.position_m.x()));
      points.push_back(rounded(point.position_m.y()));
    }
    branches.push_back(std::move(points));
  }
  Json points = Json::array();
  for (const topomap::ScanPoint& point : map.points) {
    points.push_back(rounded(point.x_m));
    points.push_back(rounded(point.y_m));
  }
  Json json = {{"session", std::to_string(map.stop.session)}, {"number", map.stop.number}};
  if (T_map_stop) set_pose(json, *T_map_stop);
  json["laser_m"] = Json::array({rounded(map.T_robot_laser.x_m), rounded(map.T_robot_laser.y_m)});
  json["nodes"] = std::move(nodes);
  json["branches"] = std::move(branches);
  json["points_m"] = std::move(points);
  return json;
}

Json drive_json(const storage::MapDocument& map, std::size_t first) {
  const auto& stops = map.trajectory.stops;
  Json out = Json::array();
  const std::size_t end = std::min(stops.size(), first + kDriveStops);
  for (std::size_t i = first; i < end; ++i) {
    const topomap::StopPose& stop = stops[i];
    Json json = {{"stamp_s", seconds(stop.stamp_ns)}};
    if (stop.located) {
      set_pose(json, stop.T_map_robot);
      json["outline_cm"] = outline_json(map.local_maps[i]);
    }
    if (map.local_maps[i].starts_drive) json["starts_drive"] = true;
    out.push_back(std::move(json));
  }
  Json json = {{"total", stops.size()},
               {"version", std::to_string(map.trajectory.version)},
               {"first", first},
               {"stops", std::move(out)}};
  if (!map.local_maps.empty()) {
    const geometry::Pose2& T_robot_laser = map.local_maps.front().T_robot_laser;
    json["laser_m"] = Json::array({rounded(T_robot_laser.x_m), rounded(T_robot_laser.y_m)});
  }
  return json;
}

}  // namespace topogeo::web
