#include "navigation_step.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {
namespace {

NavigatorConfig checked(const NavigatorConfig& config) {
  check(config);
  return config;
}

}  // namespace

NavigationStep::NavigationStep(const NavigatorConfig& settings)
    : config(checked(settings)),
      poses(config),
      base(config.guard, config.stuck_s),
      surroundings(config.blockage_s),
      driver(config),
      wait({config.obstacle_wait_s, config.obstacle_wait_s + RouteDriver::kPlanEvery_s,
            config.route_wait_s}),
      arrival(config),
      relocalization(config.look_around_m, config.guard.minimum_turning_radius_m) {}

geometry::Velocity NavigationStep::step(std::int64_t at_ns) {
  now_ns = std::max(now_ns, at_ns);
  status.busy_machine = false;
  locate();
  surroundings.update(status.T_map_robot ? routes.space() : nullptr, poses.keeper(), now_ns);
  if (goal.arrived()) {
    // A list of goals or an exploration goes on after a resume.
    return stop(NavigatorState::kArrived, goal.paused() ? HaltReason::kPaused : HaltReason::kNone,
                status.message);
  }
  if (!goal.order()) {
    return goal.cancelled() ? stop(NavigatorState::kIdle, HaltReason::kCancelled, "cancelled")
                            : stop(NavigatorState::kIdle, HaltReason::kNone, "no goal");
  }
  std::string message;
  const HaltReason reason = halted(message);
  if (reason != HaltReason::kNone) return halt(reason, std::move(message));
  if (!status.T_map_robot) return relocalize();
  if (routes.map() == nullptr) take_route();
  if (routes.space() == nullptr) {
    return stop(NavigatorState::kStopped, HaltReason::kNoMap, "no map received yet");
  }
  const geometry::Pose2 pose = *status.T_map_robot;
  if (!routes.space()->frame().cell_of(pose.position_m())) {
    return stop(NavigatorState::kStopped, HaltReason::kOutsideMap,
                fmt::format("the robot is at {:.2f}, {:.2f}, outside the map", pose.x_m, pose.y_m));
  }
  take_route();
  if (!routes.has_route()) return wait_for_route();
  return drive(pose);
}

// Updates the pose, and drops everything that was placed by a wrong one.
void NavigationStep::locate() {
  constexpr double kCorrected_m = 0.05;  // a smaller correction needs no other path
  constexpr double kMemory_m = 0.15;     // a larger jump misplaces obstacles
  constexpr double kRoute_m = 0.5;       // a larger jump may change the start of the route
  if (goal.order()) status.driven_m += poses.take_driven_m();
  const bool primitive_finished = !driver.follower().take_finished().empty();
  if (const auto corrected_m = poses.update(primitive_finished, now_ns)) {
    if (*corrected_m > kCorrected_m) driver.need_path();
    arrival.note_look();
  }
  status.T_map_robot = poses.keeper().good_pose(now_ns);
  const double jump_m = poses.take_jump_m();
  if (jump_m > kMemory_m) surroundings.forget();
  if (jump_m > kRoute_m) driver.doubt_route();
  // With an uncertain pose the new points would be misplaced, so the previous ones stay.
  if (status.T_map_robot && poses.keeper().tracking()) {
    base.keep_off(now_ns, limits.near_m(*status.T_map_robot));
  }
}

/// The reason for no motion at all; kNone if it may move.
HaltReason NavigationStep::halted(std::string& message) const {
  if (goal.paused()) {
    message = "paused; drives on after a resume";
    return HaltReason::kPaused;
  }
  if (!poses.keeper().has_odometry(now_ns)) {
    message = fmt::format("no odometry for more than {:.1f} s", config.oldest_odometry_s);
    return HaltReason::kNoOdometry;
  }
  return base.halted(now_ns, message);
}

geometry::Velocity NavigationStep::halt(HaltReason reason, std::string message) {
  driver.need_path();
  arrival.interrupt();
  base.release();
  return stop(NavigatorState::kStopped, reason, std::move(message));
}

geometry::Velocity NavigationStep::relocalize() {
  driver.doubt_route();
  driver.need_path();
  surroundings.forget();
  if (status.reason != HaltReason::kPoseLost) relocalization.begin(now_ns);
  Relocalization::Step next =
      relocalization.step({poses.keeper().why_not(now_ns), goal.order()->look_around,
                           poses.keeper().doubtful(), poses.keeper().T_odom_robot(now_ns)},
                          base.guard(), now_ns);
  if (!next.wanted) {
    return stop(NavigatorState::kRelocalizing, HaltReason::kPoseLost, std::move(next.message));
  }
  status.state = NavigatorState::kRelocalizing;
  status.reason = HaltReason::kPoseLost;
  status.message = std::move(next.message);
  return command(*next.wanted);
}

void NavigationStep::take_route() {
  RouteKeeper::Use use;
  if (wait.reported()) use.least_blockages_version = surroundings.blockages().version;
  if (!driver.needs_path() && !wait.reported()) use.path = driver.follower().path();
  use.settles = arrival.settling();
  switch (routes.take_offer(use)) {
    case RouteAnswer::kKept:
      return;
    case RouteAnswer::kRefused:
      driver.forget();
      return;
    case RouteAnswer::kTaken:
      ++status.routes;
      // Without a map, the memory belongs to the cells around the previous route.
      if (routes.map() == nullptr) surroundings.forget();
      wait.forget();
      base.release();
      driver.trust_route();
      driver.need_path();
      arrival.reset();
      return;
  }
}

geometry::Velocity NavigationStep::wait_for_route() {
  if (!routes.refused().empty()) {
    return stop(
        surroundings.anything_reported() ? NavigatorState::kBlocked : NavigatorState::kStopped,
        HaltReason::kNoRoute, routes.refused());
  }
  const double waited_s = routes.waited_s(now_ns);
  return stop(driver.doubts_route() ? NavigatorState::kRelocalizing : NavigatorState::kStopped,
              HaltReason::kWaitsForRoute,
              waited_s < config.route_wait_s
                  ? "waits for the planner"
                  : fmt::format("the planner has not answered for {:.0f} s", waited_s));
}

geometry::Velocity NavigationStep::drive(const geometry::Pose2& T_map_robot) {
  std::optional<double> progress_m;
  if (!arrival.settling() && driver.follower().has_path() && !driver.needs_path()) {
    progress_m = driver.follower().progress_m();
  }
  if (poses.must_stand(arrival.needs_look(), progress_m, now_ns)) {
    return stop(NavigatorState::kRelocalizing, HaltReason::kNone, "stops to check its position");
  }
  if (arrival.settling()) return settle(T_map_robot);
  // Far from its route it waits for one from its place; if none comes, it returns to the old one.
  if (driver.astray(T_map_robot.position_m()) && routes.wait_s(now_ns) < config.route_wait_s) {
    return stop(NavigatorState::kRelocalizing, HaltReason::kWaitsForRoute,
                "off its route; waits for a new one");
  }
  return follow(T_map_robot);
}

geometry::Velocity NavigationStep::follow(const geometry::Pose2& T_map_robot) {
  constexpr double kNearEnough_m = 0.08;  // for goals too narrow for the last centimetres
  constexpr double kStays_s = 15.0;       // longer than the last centimetres and a turn
  const SeenObstacles obstacles = surroundings.seen(now_ns);
  const RouteDriver::Scene scene{
      routes, T_map_robot, obstacles, wait.over(now_ns), now_ns, surroundings.blockages().points_m};
  if (driver.needs_path() || !driver.follower().has_path()) {
    if ((wait.waits() && driver.just_planned(now_ns)) || !find_path(scene)) {
      if (!driver.refused().empty()) {
        return stop(NavigatorState::kStopped, HaltReason::kNoRoute, driver.refused());
      }
      return wait_for_obstacle();
    }
  }
  const bool held = base.held(now_ns);
  const RouteDriver::Step driven = driver.follow(scene, held);
  if (driven.another_path) {
    base.release();
    begin_path();
  }
  const bool hindered = driven.before_block || (held && !driven.another_path);
  const bool near = (routes.goal_m() - T_map_robot.position_m()).norm() < kNearEnough_m &&
                    may_end_in(T_map_robot.theta_rad);
  if (!near) near_since_ns.reset();
  if (near && !near_since_ns) near_since_ns = now_ns;
  // Repeated paths round obstacles that only a sonar hears bring it no nearer either.
  const bool stays = near && elapsed_s(*near_since_ns, now_ns) > kStays_s;
  if (near && (hindered || stays)) {
    near_since_ns.reset();
    return settle_here();
  }
  if (hindered) {
    wait.begin(now_ns, status.driven_m);
  } else {
    wait.drive_on(status.driven_m);
  }
  if (driven.follower.done) {
    near_since_ns.reset();  // it arrives: its corrections are counted
    arrival.begin(now_ns);
    return settle(T_map_robot);
  }
  status.state = NavigatorState::kDriving;
  status.reason = HaltReason::kNone;
  status.rest_m = driven.follower.rest_m;
  status.rest_s = driven.follower.rest_s;
  status.message = fmt::format("drives, {:.1f} m to go", driven.follower.rest_m);
  const geometry::Velocity allowed = command(driven.follower.command);
  if (hindered) describe_wait();
  return allowed;
}

bool NavigationStep::find_path(const RouteDriver::Scene& scene) {
  if (!driver.find_path(scene)) return false;
  begin_path();
  return true;
}

void NavigationStep::begin_path() {
  const RouteDriver::Detours detours = driver.take_detours();
  status.detours += detours.all;
  status.branch_detours += detours.on_branches;
  status.virtual_detours += detours.on_virtual;
  poses.set_path(driver.follower().path(), routes.route().nodes_m);
  routes.stop_waiting();
}

geometry::Velocity NavigationStep::wait_for_obstacle() {
  wait.begin(now_ns, status.driven_m);
  describe_wait();
  return stop(status.state, status.reason, status.message);
}

// Reports the obstacles in the way as soon as that is due.
void NavigationStep::describe_wait() {
  constexpr double kAround_m = 1.0;  // of the obstacles in the way: enough to fill a door
  if (wait.report_due(now_ns)) {
    const auto& block = driver.block();
    const auto& pose = status.T_map_robot;
    const Eigen::Vector2d robot_m = pose ? pose->position_m() : Eigen::Vector2d::Zero();
    surroundings.report(block ? block->obstacle_m : robot_m,
                        block ? kAround_m : config.detour.half_side_m, routes.space()->frame(),
                        now_ns);
    wait.set_reported(now_ns);
  }
  status.state = NavigatorState::kBlocked;
  status.reason = wait.reason();
  status.message = wait.message(driver.describe_block(), now_ns);
}

geometry::Velocity NavigationStep::settle(const geometry::Pose2& T_map_robot) {
  ArrivalStep next = arrival.step({T_map_robot, poses.keeper().fix_ns(), poses.keeper().tracking(),
                                   routes.goal_m(), routes.route().heading_rad},
                                  now_ns);
  if (next.kind == ArrivalStep::Kind::kArrived) {
    goal.arrive();
    driver.forget();
    status.rest_m = 0.0;
    status.rest_s = 0.0;
    return stop(NavigatorState::kArrived, HaltReason::kNone, std::move(next.message));
  }
  std::string message = next.message;
  if (next.kind == ArrivalStep::Kind::kMoves) correct(T_map_robot, std::move(next));
  return stop(NavigatorState::kDriving, HaltReason::kNone, std::move(message));
}

// A base that cannot turn on the spot needs a manoeuvre to another heading.
bool NavigationStep::may_end_in(double heading_rad) const {
  constexpr double kNearEnough_rad = 0.15;
  const std::optional<double>& wanted_rad = routes.route().heading_rad;
  if (config.guard.minimum_turning_radius_m == 0.0 || !wanted_rad) return true;
  return std::fabs(geometry::wrap_angle(*wanted_rad - heading_rad)) < kNearEnough_rad;
}

// A robot that is not round may have no room to turn to the goal.
void NavigationStep::correct(const geometry::Pose2& T_map_robot, ArrivalStep next) {
  const bool steers = config.guard.minimum_turning_radius_m > 0.0;
  if (steers || (!config.guard.footprint.empty() && !next.path.empty())) {
    const SeenObstacles obstacles = surroundings.seen(now_ns);
    if (find_path({routes, T_map_robot, obstacles, true, now_ns})) return;
  }
  if (steers) {
    arrival.accept_position();
    next = {};
  }
  driver.follower().follow(std::move(next.path), next.heading_rad);
}

// An obstacle blocks the last centimetres.
geometry::Velocity NavigationStep::settle_here() {
  arrival.accept_position();
  base.release();
  wait.end();
  driver.follower().follow({}, routes.route().heading_rad);
  return stop(NavigatorState::kDriving, HaltReason::kNone,
              config.guard.minimum_turning_radius_m > 0.0
                  ? "cannot get nearer to the goal"
                  : "cannot get nearer to the goal; turns to the goal heading");
}

geometry::Velocity NavigationStep::stop(NavigatorState state, HaltReason reason,
                                        std::string message) {
  status.state = state;
  status.reason = reason;
  InputDelays::Reason why = delays.explain(reason, std::move(message), now_ns);
  status.message = std::move(why.message);
  status.busy_machine = why.busy_machine;
  status.command = {};
  driver.follower().commanded({}, now_ns);
  base.stand();
  return {};
}

geometry::Velocity NavigationStep::command(const geometry::Velocity& wanted) {
  const GuardedBase::Command command =
      base.command(wanted, poses.keeper().T_odom_robot(now_ns), now_ns);
  const GuardVerdict& verdict = command.verdict;
  status.free_ahead_m = verdict.free_m;
  if (command.newly_stopped) ++status.guard_stops;
  if (command.stopped) {
    if (verdict.contact_m && status.T_map_robot) {
      surroundings.add_contact(*status.T_map_robot * *verdict.contact_m, now_ns);
    }
    status.message = verdict.message;
  }
  status.command = verdict.allowed;
  driver.follower().commanded(verdict.allowed, now_ns);
  return verdict.allowed;
}

}  // namespace topogeo::navigation
