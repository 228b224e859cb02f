// Shortest route on the global topo-geometric map.
//
// Thesis, chapter 1 and 9.2 (docs/algorithms.md, "Use of the map"): aim and future work there; the
// method is own.
// The graph's edges are the branches, as long as their curves; start and goal split the branches at
// the nearest safe places. A robot moves along branches only, so a route keeps the largest possible
// distance to the walls and is a little longer than the shortest free path. Virtual branches are
// paths that the robot has driven without seeing much: they are open whatever their clearance, and
// taken where nothing else leads to the goal. What is filled now and no-go, slow and one-way zones
// count as on the grid.
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
  std::vector<RoutePart> parts;           ///< one for each of them
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
  kStartShut = 8,     ///< no straight line leads from the start to a branch near by
  kGoalShut = 9,
  kClosed = 10,  ///< only by what is filled now or a zone forbids
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

/// What is known besides nodes and branches.
struct PlanScene {
  /// The grid of the same map: lines from start and goal to a branch cross none of its obstacles.
  const FreeSpace* space = nullptr;
  std::span<const DrawnZone> zones{};           ///< no-go, slow and one-way ones count
  std::span<const DrawnLine> lines{};           ///< walls count
  std::span<const Eigen::Vector2d> filled_m{};  ///< something is there that is not on the map
  /// Whether the line from the last branch to the goal must be proved to be free: by the grid, or
  /// by the clearance of the branch. Otherwise config.max_snap_m alone decides.
  bool prove_goal = false;
};

/// Shortest route between two points of the map frame, metres. Throws std::invalid_argument when
/// the configuration is out of range; everything else is a status.
PlanResult plan(const topomap::GlobalMap& map, const Eigen::Vector2d& from_m,
                const Eigen::Vector2d& to_m, const PlanningConfig& config = {},
                const PlanScene& scene = {});

/// Shortest route between two nodes named by MapNode::id, otherwise like `plan`.
PlanResult plan_between_nodes(const topomap::GlobalMap& map, std::uint32_t from_node,
                              std::uint32_t to_node, const PlanningConfig& config = {});

}  // namespace topogeo::planning
