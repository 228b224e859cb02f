// Shortest route on the global topo-geometric map.
//
// The Thesis has it as aim and future work, chapter 1 and 9.2 (docs/algorithms.md, "Use of the
// map"); the method is own. The graph's edges are the branches, weighted by their lengths; start
// and goal split the branches at the nearest safe places. A robot moves along branches only, so a
// route keeps the largest possible distance to the walls and is a little longer than the shortest
// free path. Virtual branches are paths that the robot has driven without seeing much: they are
// open at any clearance, but used only if nothing else leads to the goal. Present obstacles and
// no-go, slow and one-way zones count as on the grid.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/drawn_zone.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/planning_config.hpp"
#include "topogeo/planning/route_parts.hpp"
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
  std::vector<RoutePart> parts;           ///< one for each of the branches
  double length_m = 0.0;
  double min_clearance_m = 0.0;
};

enum class PlanStatus : std::uint8_t {
  kFound = 0,
  kEmptyMap = 1,     ///< no branches
  kTooNarrow = 2,    ///< the map has paths, but none wide enough for the robot
  kStartTooFar = 3,  ///< too far from every branch that is wide enough
  kGoalTooFar = 4,
  kNotConnected = 5,  ///< start and goal lie on separate parts of the map
  kUnknownNode = 6,   ///< no node with that id, or none with a branch
  kInvalidPoint = 7,  ///< a coordinate is not finite
  kStartShut = 8,     ///< no straight line leads from the start to a nearby branch
  kGoalShut = 9,
  kClosed = 10,  ///< closed only by present obstacles or a zone
};

/// Short text for logs and messages: "found", "empty map", ...
std::string_view describe(PlanStatus status);

/// Place on the map that a start or goal was moved to.
struct Snap {
  RoutePoint nearest;
  double distance_m = 0.0;
  std::uint32_t branch_id = 0;
};

struct PlanResult {
  PlanStatus status = PlanStatus::kEmptyMap;
  std::string reason;         ///< one line for people; empty if found
  Route route;                ///< set if found
  std::optional<Snap> start;  ///< nearest passable place on the map, if there is one
  std::optional<Snap> goal;

  [[nodiscard]] bool found() const { return status == PlanStatus::kFound; }
};

/// Inputs besides nodes and branches.
struct PlanScene {
  /// The grid of the same map: lines from start and goal to a branch must not cross its obstacles.
  const FreeSpace* space = nullptr;
  std::span<const DrawnZone> zones{};           ///< uses no-go, slow and one-way zones
  std::span<const DrawnLine> lines{};           ///< uses walls
  std::span<const Eigen::Vector2d> filled_m{};  ///< points of obstacles that are not on the map
  /// Whether the grid or the clearance of the branch must prove the line from the last branch to
  /// the goal to be free. Otherwise config.max_snap_m alone decides.
  bool prove_goal = false;
};

/// Shortest route between two points of the map frame, metres. Throws std::invalid_argument if the
/// configuration is out of range; every other fault is a status.
PlanResult plan(const topomap::GlobalMap& map, const Eigen::Vector2d& from_m,
                const Eigen::Vector2d& to_m, const PlanningConfig& config = {},
                const PlanScene& scene = {});

/// Shortest route between two nodes named by MapNode::id, otherwise like `plan`.
PlanResult plan_between_nodes(const topomap::GlobalMap& map, std::uint32_t from_node,
                              std::uint32_t to_node, const PlanningConfig& config = {});

}  // namespace topogeo::planning
