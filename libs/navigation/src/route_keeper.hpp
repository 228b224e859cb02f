// The planner's routes for the goal: the one offered, the one in hand, and since when one is waited
// for.
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
  kKept,     ///< no other route: none was offered, it cannot be used, or the path stays as it is
  kRefused,  ///< the planner has no route; none is in hand any more
  kTaken,    ///< another route is in hand
};

class RouteKeeper {
 public:
  /// The map that routes are of; null: there is none, and no route. False when the route in hand
  /// has no point on the new map.
  bool set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version);
  [[nodiscard]] const planning::HybridMap* map() const { return map_.get(); }
  /// The floor to drive on: that of the map, as the route in hand opens it (floor_of). Null while
  /// there is neither a map nor a route along branches.
  [[nodiscard]] const planning::FreeSpace* space() const {
    if (floor_) return floor_.get();
    return map_ ? &map_->space() : nullptr;
  }
  /// Whether the route in hand follows branches.
  [[nodiscard]] bool on_branches() const { return floor_ != nullptr; }

  /// A new goal: forgets all routes and waits for one from now on, or, where that is not known (0),
  /// from when it is asked how long.
  void expect(std::int64_t now_ns);
  void cancel();
  void forget();
  /// The route in hand cannot be followed on the new map: waits for another one from now on.
  void drop(std::int64_t now_ns);

  void offer(const RoutePlan& route) { offered_ = route; }

  struct Use {
    /// A route that avoids an older version of the blockages is not taken.
    std::uint64_t least_blockages_version = 0;
    /// That the robot follows; empty: it needs a new one. The same route again, from a little
    /// further on, changes nothing for a robot that is on it.
    std::span<const planning::PathSample> path;
    bool settles = false;  ///< at the goal
  };
  /// Takes the offered route if it is usable. Routes of a map that is to come wait for it. Those of
  /// an older map are good where the new one has room for them; what an older map has no route for,
  /// the planner is asked again by the new one.
  RouteAnswer take_offer(const Use& use);

  [[nodiscard]] bool has_route() const { return !cells_.empty(); }
  [[nodiscard]] const RoutePlan& route() const { return route_; }
  [[nodiscard]] const std::vector<planning::Cell>& cells() const { return cells_; }
  [[nodiscard]] const Eigen::Vector2d& goal_m() const { return route_.points_m.back(); }
  /// Why there is no route; empty while the planner has not answered.
  [[nodiscard]] const std::string& refused() const { return refused_; }

  /// Waits for a route from where the robot is, from now on unless it does already; for how long.
  double wait_s(std::int64_t now_ns);
  void stop_waiting() { waits_ns_.reset(); }
  /// How long a route has been waited for, or since the goal was given.
  double waited_s(std::int64_t now_ns);

 private:
  [[nodiscard]] bool usable(const RoutePlan& route, std::uint64_t least_blockages_version) const;
  [[nodiscard]] bool fits(const RoutePlan& route) const;
  bool take(const RoutePlan& route);

  std::shared_ptr<const planning::HybridMap> map_;
  std::uint64_t map_version_ = 0;
  std::optional<RoutePlan> offered_;  ///< the last one for the goal that was not taken yet
  std::string refused_;
  RoutePlan route_;
  std::vector<planning::Cell> cells_;                 ///< of the route, neighbours each
  std::shared_ptr<const planning::FreeSpace> floor_;  ///< of a route along branches
  std::int64_t goal_ns_ = 0;                          ///< when the goal was given; 0: not known
  std::optional<std::int64_t> waits_ns_;
};

}  // namespace topogeo::navigation
