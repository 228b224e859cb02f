// The planner's routes for the goal: the offered and the current one, and the time of waiting for
// one.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

enum class RouteAnswer {
  kKept,     ///< no change: none was offered, it cannot be used, or the path is the same
  kRefused,  ///< the planner has no route; drops the current one
  kTaken,    ///< the route has changed
};

class RouteKeeper {
 public:
  /// Sets the map of the routes; null: no map and no route. False if the current route has no point
  /// on the new map.
  bool set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version);
  [[nodiscard]] const planning::HybridMap* map() const { return map_.get(); }
  /// The floor to drive on: that of the map, opened by the current route (floor_of). Null if there
  /// is neither a map nor a route along branches.
  [[nodiscard]] const planning::FreeSpace* space() const {
    if (floor_) return floor_.get();
    return map_ ? &map_->space() : nullptr;
  }
  /// Whether the current route follows branches.
  [[nodiscard]] bool on_branches() const { return floor_ != nullptr; }

  /// A new goal: forgets all routes and starts to wait for one at `now_ns`, or, if that is unknown
  /// (0), when the waiting time is first asked for.
  void expect(std::int64_t now_ns);
  void cancel();
  void forget();
  /// The current route cannot be followed on the new map: waits for another one from now on.
  void drop(std::int64_t now_ns);

  void offer(const RoutePlan& route) { offered_ = route; }

  struct Use {
    /// Ignores a route that avoids an older version of the blockages.
    std::uint64_t least_blockages_version = 0;
    /// The path that the robot follows; empty: it needs a new one. The same route from a place
    /// further on changes nothing for a robot on it.
    std::span<const planning::PathSample> path;
    bool settles = false;  ///< at the goal
  };
  /// Takes the offered route if it is usable. A route of a future map waits for that map. A route
  /// of an older map is good if the new one has room for it; if an older map had no route, the new
  /// map counts.
  RouteAnswer take_offer(const Use& use);

  [[nodiscard]] bool has_route() const { return !cells_.empty(); }
  [[nodiscard]] const RoutePlan& route() const { return route_; }
  [[nodiscard]] const std::vector<planning::Cell>& cells() const { return cells_; }
  [[nodiscard]] const Eigen::Vector2d& goal_m() const { return route_.points_m.back(); }
  /// The reason for a missing route; empty while the planner has not answered.
  [[nodiscard]] const std::string& refused() const { return refused_; }

  /// Starts waiting for a route from the robot's place, unless it does already; returns the time
  /// waited.
  double wait_s(std::int64_t now_ns);
  void stop_waiting() { waits_ns_.reset(); }
  /// Time since a route has been awaited, or since the goal was given.
  double waited_s(std::int64_t now_ns);

 private:
  [[nodiscard]] bool usable(const RoutePlan& route, std::uint64_t least_blockages_version) const;
  [[nodiscard]] bool fits(const RoutePlan& route) const;
  bool take(const RoutePlan& route);

  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t map_version_ = 0;
  std::optional<RoutePlan> offered_;  ///< the last one for the goal, not yet taken
  std::string refused_;
  RoutePlan route_;
  std::vector<planning::Cell> cells_;                 ///< connected cells of the route
  std::shared_ptr<const planning::FreeSpace> floor_;  ///< of a route along branches
  std::int64_t goal_ns_ = 0;                          ///< time of the goal; 0: unknown
  std::optional<std::int64_t> waits_ns_;
};

}  // namespace topogeo::navigation
