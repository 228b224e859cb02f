// Follows the current route: searches another path if an obstacle blocks this one, and limits the
// speed before obstacles.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "topogeo/geometry/footprint.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/path_follower.hpp"

#include "local_planner.hpp"
#include "route_keeper.hpp"
#include "surroundings.hpp"

namespace topogeo::navigation {

FollowerConfig follower_config(const NavigatorConfig& config);

class RouteDriver {
 public:
  /// Shortest time between two searches for a path round an obstacle. A search takes some
  /// milliseconds, and the laser's view of an obstacle changes little in a shorter time.
  static constexpr double kPlanEvery_s = 0.3;

  explicit RouteDriver(const NavigatorConfig& config);

  /// Inputs of one step.
  struct Scene {
    const RouteKeeper& route;  ///< has a map and a route
    geometry::Pose2 T_map_robot;
    const SeenObstacles& obstacles;
    bool waited = false;  ///< the obstacle has had its time to move away
    std::int64_t now_ns = 0;
    std::span<const Eigen::Vector2d>
        reported_m{};  ///< obstacles reported to the planner, map frame
  };

  /// Requests another path from the robot's position.
  void need_path() { needs_path_ = true; }
  /// Marks the route as doubtful, because the pose was lost or has jumped.
  void doubt_route() { doubts_route_ = true; }
  void trust_route() { doubts_route_ = false; }
  void forget() {
    follower_.forget();
    refused_.clear();
  }

  [[nodiscard]] bool needs_path() const { return needs_path_; }
  [[nodiscard]] bool doubts_route() const { return doubts_route_; }
  [[nodiscard]] const PathFollower& follower() const { return follower_; }
  PathFollower& follower() { return follower_; }

  /// Whether the robot is far off its path, so that a route from its position would be better.
  bool astray(const Eigen::Vector2d& robot_m);

  /// Whether the last search for a path was less than kPlanEvery_s ago.
  [[nodiscard]] bool just_planned(std::int64_t now_ns) const;
  /// Searches a path and follows it. Returns false if there is no path, or no better one. Takes a
  /// much longer detour only after the obstacle has had its time to move away.
  bool find_path(const Scene& scene);

  struct Step {
    FollowerStep follower;
    bool another_path = false;  ///< another path was found
    bool before_block = false;  ///< stands, or nearly so, before an obstacle on the path
  };
  /// The next velocity along the path. `held`: the guard stops the robot, so another path is
  /// searched.
  Step follow(const Scene& scene, bool held);

  struct Detours {
    std::uint32_t all = 0;
    std::uint32_t on_branches = 0;  ///< detours along branches of a scan
    std::uint32_t on_virtual = 0;   ///< those of them along virtual branches
  };
  /// Detours begun since the last call.
  Detours take_detours() { return std::exchange(detours_, {}); }
  /// The obstacle that blocked the last step along the path; empty if there was none.
  [[nodiscard]] const std::optional<PathBlock>& block() const { return block_; }
  /// The result of block() as text for people.
  [[nodiscard]] std::string describe_block() const;

  /// The reason why no path is wide enough for the outline of the robot; empty if unknown.
  [[nodiscard]] const std::string& refused() const { return refused_; }

 private:
  [[nodiscard]] LocalPath plan(const Scene& scene) const;
  bool go_round(const Scene& scene);
  double speed_past_obstacles(const Scene& scene, bool& another_path);
  /// The speed that slow zones allow here and within the braking distance.
  [[nodiscard]] double speed_in_zones(const Scene& scene) const;

  const NavigatorConfig& config_;
  geometry::Footprint outline_;  ///< empty: paths of the centre are enough
  LocalPlanner planner_;
  PathFollower follower_;
  bool needs_path_ = false;
  bool doubts_route_ = false;
  bool cut_off_ = false;         ///< the last search for a path could not begin
  std::int64_t planned_ns_ = 0;  ///< time of the last search for a path
  std::string refused_;
  std::optional<PathBlock> block_;
  Detours detours_;
};

}  // namespace topogeo::navigation
