// Shortest route on the global topo-geometric map.
//
// Thesis, chapter 1 and 9.2 (docs/algorithms.md, "Use of the map"): aim and future work there; the
// method is own.
// The graph's edges are the branches, as long as their curves; start and goal split the branch that
// they snap to. A robot moves along branches only, so a route keeps the largest possible distance
// to the walls and is a little longer than the shortest free path. Virtual branches are paths that
// the robot has driven without seeing much: they are open whatever their clearance.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/planning_config.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::planning {

struct RoutePoint {
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< map frame
  double clearance_m = 0.0;
};

struct Route {
  std::vector<RoutePoint> points;         ///< from the start's to the goal's place on the map, >= 1
  std::vector<std::uint32_t> node_ids;    ///< MapNode::id of the nodes passed, in order
  std::vector<std::uint32_t> branch_ids;  ///< MapBranch::id of the branches followed, in order
  double length_m = 0.0;
  double min_clearance_m = 0.0;
};

enum class PlanStatus : std::uint8_t {
  kFound = 0,
  kEmptyMap = 1,     ///< no branches
  kTooNarrow = 2,    ///< the map has paths, but none wide enough for the robot
  kStartTooFar = 3,  ///< from every branch that is wide enough
  kGoalTooFar = 4,
  kNotConnected = 5,  ///< start and goal lie on separate parts of the map
  kUnknownNode = 6,   ///< no node of that id, or none that a branch ends at
  kInvalidPoint = 7,  ///< a coordinate is not finite
};

/// A word for logs and messages: "found", "empty map", ...
std::string_view describe(PlanStatus status);

/// Where a start or goal came to lie on the map.
struct Snap {
  RoutePoint nearest;
  double distance_m = 0.0;
  std::uint32_t branch_id = 0;
};

struct PlanResult {
  PlanStatus status = PlanStatus::kEmptyMap;
  std::string reason;         ///< one line for people; empty when found
  Route route;                ///< filled when found
  std::optional<Snap> start;  ///< nearest passable place on the map, whenever there is one
  std::optional<Snap> goal;

  [[nodiscard]] bool found() const { return status == PlanStatus::kFound; }
};

/// Shortest route between two points of the map frame, metres. Throws std::invalid_argument when
/// the configuration is out of range; everything else is a status.
PlanResult plan(const topomap::GlobalMap& map, const Eigen::Vector2d& from_m,
                const Eigen::Vector2d& to_m, const PlanningConfig& config = {});

/// Shortest route between two nodes named by MapNode::id, otherwise like `plan`.
PlanResult plan_between_nodes(const topomap::GlobalMap& map, std::uint32_t from_node,
                              std::uint32_t to_node, const PlanningConfig& config = {});

}  // namespace topogeo::planning
