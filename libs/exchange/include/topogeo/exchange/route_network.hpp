// The map as a graph of straight, directed edges for route servers: Nav2, Open-RMF.
//
// The branches become chains of pieces. A bend is left out if the piece keeps the robot's radius
// from obstacles: the polyline is simplified (Douglas and Peucker, "Algorithms for the reduction of
// the number of points required to represent a digitized line", 1973) with the least clearance
// along the piece minus the radius as tolerance, at most `tolerance_m`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/exchange/zone_rules.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::exchange {

struct NetworkSettings {
  double robot_radius_m = 0.3;  ///< least clearance that lets a robot pass; >= 0
  double tolerance_m = 0.1;     ///< largest distance between a piece and the branch, [0, 1]
  /// Uses all branches that no scan has seen, not only those that alone join parts of the graph.
  bool with_virtual = false;
  bool only_free = false;  ///< leaves out pieces that the grid forbids
};

struct NetworkNode {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  double clearance_m = 0.0;
  std::optional<std::uint32_t> map_node;  ///< index of the map's node; none for a bend
  std::optional<std::uint32_t> place;     ///< index of its place
};

/// A straight piece. Its ends are indices of RouteNetwork::nodes.
struct NetworkPiece {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double clearance_m = 0.0;             ///< least clearance along it
  std::optional<std::uint32_t> branch;  ///< MapBranch::id; none for the connection of a place
  DrivingRule rule;                     ///< never forbidden
};

struct RouteNetwork {
  std::vector<NetworkNode> nodes;  ///< first the map's in their order, then the others
  std::vector<NetworkPiece> pieces;
  Notes notes;
};

/// The ids of virtual branches that join what no other branch joins.
std::set<std::uint32_t> joining_virtual_branches(const topomap::GlobalMap& map);

/// Leaves out pieces that are too narrow for the robot or that the drawing's zones forbid. A place
/// becomes a node with a piece to the nearest point of the branches that is free on `space` (null:
/// any point); a note reports a place without one. Throws std::invalid_argument for settings out of
/// range.
RouteNetwork route_network(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                           const planning::FreeSpace* space, const NetworkSettings& settings);

}  // namespace topogeo::exchange
