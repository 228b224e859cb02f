// Drives a robot along routes of the hybrid map: a state machine without clock, threads or I/O.
//
// Its owner adds everything that comes (poses, odometry, scans, sonars, base, routes) and calls
// step() many times a second; it answers with the velocity for the base. It follows the route
// smoothly, or in motion primitives; it goes round what is not on the map as long as
// a detour can be seen (local_detour.hpp), waits for what moves, reports what stays in the way
// so that the planner finds another route, and stands still whenever it does not know where it is.
// The collision guard has the last word (docs/algorithms.md, "Driving and collision guard").
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
  /// Throws std::invalid_argument as `check`.
  explicit Navigator(const NavigatorConfig& config);
  ~Navigator();
  Navigator(Navigator&&) noexcept;
  Navigator& operator=(Navigator&&) noexcept;

  /// The map that routes are of; another one while it drives stops it until the planner has
  /// answered with a route of the new one, unless its path is free there too.
  void set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version);

  /// A new goal: the old one is forgotten, the robot stops until a route for it comes.
  void set_goal(const GoalOrder& goal);
  /// Routes for other goals are ignored; a refusal stops the robot with the planner's reason.
  void set_route(const RoutePlan& route);
  void cancel();
  void pause();
  void resume();

  // Sensors, in any order among each other; each in time order.
  void add(const PoseFix& pose);
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);
  void add(const LaserFields& fields);
  void add(const BaseCondition& base);

  /// For the reasons of a halt only; nothing else depends on them. A message came at `arrival_ns`.
  void note_arrival(TimedInput input, std::int64_t stamp_ns, std::int64_t arrival_ns);
  void set_machine(const MachineLoad& load);

  /// What the base shall do until the next call. `now_ns` never goes back.
  geometry::Velocity step(std::int64_t now_ns);

  [[nodiscard]] const NavigatorStatus& status() const;
  /// The pose of Markov localization at the last step, for others: without a laser nobody else
  /// has one. Nothing with another source of poses, and until there is odometry.
  [[nodiscard]] const std::optional<PoseFix>& markov_pose() const;
  /// What stands in the way now. A new version asks the planner for another route.
  [[nodiscard]] const BlockageReport& blockages() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace topogeo::navigation
