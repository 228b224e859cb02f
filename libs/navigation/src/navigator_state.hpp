// The parts of a Navigator and what they know of each other.
//
// step(): first everything that forbids to move at all (halt), then the pose (relocalize), then the
// route (drive): obstacles, path, arrival. Every velocity passes the guard in command().
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/navigation/navigator.hpp"
#include "topogeo/navigation/path_follower.hpp"

#include "base_watch.hpp"
#include "blockade.hpp"
#include "contact_memory.hpp"
#include "look_around.hpp"
#include "markov_mode.hpp"
#include "obstacle_memory.hpp"
#include "pose_keeper.hpp"
#include "route_way.hpp"
#include "say.hpp"

namespace topogeo::navigation {

/// What is near and not on the map: first what stands, then what may move away.
struct SeenObstacles {
  std::vector<Eigen::Vector2d> points_m;  ///< map frame
  std::size_t standing = 0;

  [[nodiscard]] std::span<const Eigen::Vector2d> standing_m() const {
    return std::span(points_m).first(standing);
  }
};

struct Navigator::State {
  explicit State(const NavigatorConfig& settings);

  // navigator_step.cpp
  geometry::Velocity step(std::int64_t at_ns);
  /// Why it must not move at all; kNone when it may.
  HaltReason halted(std::string& message);
  geometry::Velocity relocalize();
  geometry::Velocity stop(NavigatorState state, HaltReason reason, std::string message);
  /// The guard's word on a wanted velocity; what comes out is what the base is told.
  geometry::Velocity command(const geometry::Velocity& wanted);
  void use_scan();
  [[nodiscard]] bool usable(const RoutePlan& route) const;
  void use_route();
  void note_pose_jump();
  /// Where something was seen means nothing any more: the pose was wrong, or the map is another.
  void forget_obstacles();

  // navigator_drive.cpp
  geometry::Velocity drive(const geometry::Pose2& T_map_robot);
  geometry::Velocity without_route();
  bool find_path(const geometry::Pose2& T_map_robot);
  geometry::Velocity follow(const geometry::Pose2& T_map_robot);
  /// The speed that what is in the way allows; it also looks for a way round.
  double speed_past_obstacles(const geometry::Pose2& T_map_robot);
  void go_round(const geometry::Pose2& T_map_robot);
  geometry::Velocity wait_for_obstacle();
  void begin_waiting();
  void tell_waiting();
  void report_blockage();
  [[nodiscard]] SeenObstacles seen() const;
  void tell_driving(const FollowerStep& order);

  // navigator_markov.cpp
  void use_markov();
  /// Stands and looks where it is, when it is time to; nothing when it is not.
  std::optional<geometry::Velocity> look();

  // navigator_arrive.cpp
  geometry::Velocity settle_here();
  geometry::Velocity look_at_goal(const geometry::Pose2& T_map_robot);
  geometry::Velocity settle(const geometry::Pose2& T_map_robot);

  [[nodiscard]] double since_s(std::int64_t then_ns) const {
    return static_cast<double>(now_ns - then_ns) * 1e-9;
  }

  NavigatorConfig config;
  CollisionGuard guard;
  PoseKeeper keeper;
  PathFollower follower;
  ObstacleMemory memory;
  ContactMemory contacts;
  RouteWay way;
  BaseWatch base_watch;
  LookAround look_around;
  Blockade blockade;
  MarkovMode markov;

  std::shared_ptr<const planning::HybridMap> map;
  std::uint64_t map_version = 0;
  std::int64_t now_ns = 0;

  GoalOrder goal;
  bool has_goal = false;
  bool arrived = false;
  bool cancelled = false;
  bool paused = false;
  bool stuck = false;
  std::optional<BaseCondition> base;
  std::vector<ScanPoints> scans;     ///< not used for the memory yet: their pose is to come
  std::optional<RoutePlan> offered;  ///< the last route for the goal that was not taken yet
  std::string refused;               ///< why the planner has none; empty: it has not said so
  std::int64_t goal_ns = 0;          ///< since when a route is waited for

  bool needs_path = false;
  bool no_way_to_route = false;  ///< the last search for a path did not even begin
  bool lost = false;             ///< the pose was lost, or has jumped: the route may be of no use
  std::int64_t lost_ns = 0;
  std::optional<std::int64_t> waits_route_ns;  ///< since when a fresh route is waited for

  std::optional<std::int64_t> blocked_ns;  ///< since when it stands before an obstacle
  double blocked_driven_m = 0.0;           ///< what it had driven then
  bool reported = false;                   ///< that obstacle, as a blockage
  std::int64_t reported_ns = 0;
  std::int64_t planned_ns = 0;  ///< last search for a way round
  double block_ahead_m = 0.0;
  std::optional<Eigen::Vector2d> block_m;  ///< map frame
  std::optional<std::int64_t> guard_stop_ns;

  std::optional<std::int64_t> settle_ns;
  int looks = 0;  ///< turns at the goal, for the localizer to become sure
  int corrections = 0;
  bool looked_at_end = false;  ///< Markov localization has, since it settles

  NavigatorStatus status;
};

}  // namespace topogeo::navigation
