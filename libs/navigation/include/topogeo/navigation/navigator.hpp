// Drives a robot along routes of the hybrid map: a state machine without clock, threads or I/O.
//
// Its owner adds all inputs (poses, odometry, scans, sonars, base, routes) and calls step() many
// times a second, which returns the velocity for the base. It follows the route smoothly, or in
// motion primitives. It drives round obstacles that are not on the map if it sees a detour
// (local_detour.hpp), waits for moving ones, reports remaining ones so that the planner finds
// another route, and stands still without a pose. The collision guard decides last
// (docs/algorithms.md, "Driving and collision guard").
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/markov_tracker.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/local_detour.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

class Navigator {
 public:
  /// Throws std::invalid_argument like `check`.
  explicit Navigator(const NavigatorConfig& config);
  ~Navigator();
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;

  /// Sets the map of the routes. A new one while driving stops the robot until the planner has
  /// answered with a route on it, unless the present path is free there too.
  void set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version);

  /// Replaces the goal: the robot stops until a route for it comes.
  void set_goal(const GoalOrder& goal);
  /// Routes for other goals are ignored; a refusal stops the robot with the planner's reason.
  void set_route(const RoutePlan& route);
  void cancel();
  void pause();
  void resume();
  /// The reason why the robot stands with any goal although the base reports none, for example an
  /// operator's stop; empty: none.
  void set_stopped(std::string why);
  /// The base did not move when ordered to: stands until a resume or another goal.
  [[nodiscard]] bool is_stuck() const;
  /// Restores that state, so that another navigator does not push against what holds the base.
  void stay_stuck();
  /// Restores the state of a robot that has arrived at the goal that was set last, with the message
  /// of its status. It has no effect on a pause.
  void stay_arrived(const std::string& message);

  // Sensors, in any relative order; each in time order.
  void add(const PoseFix& pose);
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);
  void add(const LaserFields& fields);
  void add(const BaseCondition& base);

  /// Used only for the reasons of a halt. A message came at `arrival_ns`.
  void note_arrival(TimedInput input, std::int64_t stamp_ns, std::int64_t arrival_ns);
  void set_machine(const MachineLoad& load);

  /// The command for the base until the next call. `now_ns` never goes back.
  geometry::Velocity step(std::int64_t now_ns);

  [[nodiscard]] const NavigatorStatus& status() const;
  /// The pose of Markov localization at the last step, published for other programs, which have
  /// none without a laser. Nothing with another source of poses, and until there is odometry.
  [[nodiscard]] const std::optional<PoseFix>& markov_pose() const;
  /// Obstacles in the way now. A new version asks the planner for another route.
  [[nodiscard]] const BlockageReport& blockages() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace topogeo::navigation
