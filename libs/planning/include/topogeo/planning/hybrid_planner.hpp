// Routes on the hybrid map (MACONDO, III.3; docs/algorithms.md, "Hybrid map and planner").
//
// If start and goal are in one zone: A* on the grid, the graph is ignored. If they are in two
// zones, adjacent or not: paths on the grid from the start to every node of its zone and from every
// node of the goal's zone to the goal, Dijkstra on the graph between every pair of them; the
// cheapest sum wins.
//
// Additions to MACONDO, because the middle of a border can lie off the shortest path: short routes,
// and pieces of the others, are planned again on the grid; and a long path within a zone is
// compared with paths that leave the zone and return.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/hybrid_planner_config.hpp"
#include "topogeo/planning/route_parts.hpp"

namespace topogeo::planning {

/// BorderNode::id.
struct NodeNumber {
  std::uint32_t id = 0;
};

/// Target: a point of the map frame (m), a node, or the name of a place (see find_place).
using Target = std::variant<Eigen::Vector2d, NodeNumber, std::string>;

/// Parts of the map that are unusable now.
struct Closures {
  std::vector<std::uint32_t> nodes{};  ///< impassable borders (a door found shut)
  std::vector<std::uint32_t> edges{};  ///< blocked paths through a zone
  /// Cells occupied by obstacles that are not on the map; the robot's centre keeps the same
  /// distance as from mapped obstacles. In any order; cells outside of the grid also count.
  std::vector<Cell> cells{};
};

enum class RouteStatus : std::uint8_t {
  kFound = 0,
  kInvalidPoint = 1,   ///< a coordinate is not finite
  kUnknownPlace = 2,   ///< no place with that name
  kUnknownNode = 3,    ///< no node with that number
  kStartOutside = 4,   ///< outside of the grid, or in unknown cells
  kStartOccupied = 5,  ///< in an obstacle or a forbidden cell
  kGoalOutside = 6,
  kGoalOccupied = 7,
  kUnreachable = 8,  ///< no path, or no open one now
};

/// Short text for logs and messages: "found", "unknown place", ...
std::string_view describe(RouteStatus status);

enum class RouteKind : std::uint8_t { kSameZone = 0, kAdjacentZones = 1, kDistantZones = 2 };

struct HybridRoute {
  RouteStatus status = RouteStatus::kUnreachable;
  std::string reason;  ///< one line for people; empty if found
  /// If the goal is unreachable but the start is good: the nearest reachable place to it.
  std::optional<Eigen::Vector2d> nearest_reachable_m;

  // Set if found.
  RouteKind kind = RouteKind::kSameZone;
  std::vector<Cell> cells;                ///< connected, from the start's to the goal's
  double cost_m = 0.0;                    ///< length over the centres of the cells
  std::vector<Eigen::Vector2d> points_m;  ///< the same path straightened, from start to goal
  std::vector<double> clearances_m;  ///< of the cells of `points_m`, infinite without obstacles
  double length_m = 0.0;             ///< of `points_m`
  double min_clearance_m = 0.0;      ///< least of the cells
  std::vector<ZoneId> zones;         ///< in the order of the path
  std::vector<std::uint32_t> nodes;  ///< in order; empty if it stays in one zone
  std::vector<std::uint32_t> edges;  ///< between them
  /// Basis of the plan. A route along branches (goal_planner.hpp) has neither cells nor zones.
  std::vector<RoutePart> parts;

  [[nodiscard]] bool found() const { return status == RouteStatus::kFound; }
};

/// Total length of the parts of a route with one basis, metres.
double length_on(const HybridRoute& route, PlannedOn on);

/// Plans on one map, which must outlive it.
class HybridPlanner {
 public:
  /// Throws std::invalid_argument like `check`.
  explicit HybridPlanner(const HybridMap& map, const HybridPlannerConfig& config = {});

  /// Every fault of start and goal is a status. Throws std::invalid_argument only for closed nodes
  /// or edges that do not exist.
  [[nodiscard]] HybridRoute plan(const Eigen::Vector2d& from_m, const Target& to,
                                 const Closures& closed = {}) const;

 private:
  const HybridMap& map_;
  HybridPlannerConfig config_;
};

/// The same by A* over the whole grid: the shortest path over cells, in much more time, without
/// zones, nodes and edges.
HybridRoute plan_on_grid(const FreeSpace& space, const Eigen::Vector2d& from_m,
                         const Eigen::Vector2d& to_m, const HybridPlannerConfig& config = {});

}  // namespace topogeo::planning
