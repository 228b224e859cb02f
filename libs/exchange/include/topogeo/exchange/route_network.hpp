// The map as a graph of straight, directed edges, as route servers read it: Nav2, Open-RMF.
//
// The branches become chains of pieces. A bend is left out as long as the piece stays as far from
// obstacles as the robot's radius: the polyline is simplified (Douglas and Peucker, "Algorithms for
// the reduction of the number of points required to represent a digitized line", 1973) with the
// least clearance along the piece less the radius as tolerance, at most `tolerance_m`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
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
  double robot_radius_m = 0.3;  ///< a robot passes where the clearance is at least that; >= 0
  double tolerance_m = 0.1;     ///< how far a piece may pass from the branch, [0, 1]
  bool with_virtual = false;    ///< also branches that no scan has seen
  bool only_free = false;       ///< leaves out pieces that the grid forbids
};

struct NetworkNode {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  double clearance_m = 0.0;
  std::optional<std::uint32_t> map_node;  ///< index of the map's node; none of a bend
  std::optional<std::uint32_t> place;     ///< index of the place that it is
};

/// A straight piece. Its ends are indices of RouteNetwork::nodes.
struct NetworkPiece {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  double clearance_m = 0.0;             ///< least along it
  std::optional<std::uint32_t> branch;  ///< MapBranch::id; none of the way to a place
  DrivingRule rule;                     ///< never forbidden
};

struct RouteNetwork {
  std::vector<NetworkNode> nodes;  ///< first the map's in their order, then all others
  std::vector<NetworkPiece> pieces;
  Notes notes;
};

/// Leaves out what the robot is too wide for and what the zones of the drawing forbid. A place
/// becomes a node with a piece to the nearest point of the branches that is free on `space` (null:
/// anywhere); without one there is a note. Throws std::invalid_argument for settings out of range.
RouteNetwork route_network(const topomap::GlobalMap& map, const storage::MapDrawing& drawing,
                           const planning::FreeSpace* space, const NetworkSettings& settings);

}  // namespace topogeo::exchange
