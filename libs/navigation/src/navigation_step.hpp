// One step of the navigator: from the current state to the velocity command.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/drawn_limits.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

#include "arrival.hpp"
#include "goal_in_hand.hpp"
#include "guarded_base.hpp"
#include "input_delays.hpp"
#include "obstacle_wait.hpp"
#include "pose_sources.hpp"
#include "relocalization.hpp"
#include "route_driver.hpp"
#include "route_keeper.hpp"
#include "surroundings.hpp"

namespace topogeo::navigation {

/// Checks every reason not to move first, then the pose, then the route; every velocity passes the
/// collision guard in command().
struct NavigationStep {
  /// Throws std::invalid_argument like check(NavigatorConfig).
  explicit NavigationStep(const NavigatorConfig& settings);

  geometry::Velocity step(std::int64_t at_ns);

  void locate();
  HaltReason halted(std::string& message) const;
  geometry::Velocity halt(HaltReason reason, std::string message);
  geometry::Velocity relocalize();
  void take_route();
  geometry::Velocity wait_for_route();

  geometry::Velocity drive(const geometry::Pose2& T_map_robot);
  geometry::Velocity follow(const geometry::Pose2& T_map_robot);
  geometry::Velocity wait_for_obstacle();
  void describe_wait();
  geometry::Velocity settle(const geometry::Pose2& T_map_robot);
  void correct(const geometry::Pose2& T_map_robot, ArrivalStep next);
  geometry::Velocity settle_here();
  [[nodiscard]] bool may_end_in(double heading_rad) const;
  bool find_path(const RouteDriver::Scene& scene);
  void begin_path();

  geometry::Velocity stop(NavigatorState state, HaltReason reason, std::string message);
  geometry::Velocity command(const geometry::Velocity& wanted);

  NavigatorConfig config;
  std::int64_t now_ns = 0;
  GoalInHand goal;
  PoseSources poses;
  GuardedBase base;
  InputDelays delays;
  Surroundings surroundings;
  RouteKeeper routes;
  RouteDriver driver;
  DrawnLimits limits;
  ObstacleWait wait;
  Arrival arrival;
  Relocalization relocalization;
  std::optional<std::int64_t> near_since_ns;  ///< start of the time within centimetres of the goal
  NavigatorStatus status;
};

}  // namespace topogeo::navigation
