// What comes before driving: reasons to stand still, the pose, scans and routes that have come.
#include <algorithm>
#include <cmath>
#include <utility>

#include "navigator_state.hpp"

namespace topogeo::navigation {

geometry::Velocity Navigator::State::stop(NavigatorState state, HaltReason reason,
                                          std::string message) {
  status.state = state;
  status.reason = reason;
  status.message = std::move(message);
  status.command = {};
  follower.commanded({}, now_ns);
  base_watch.reset();
  return {};
}

geometry::Velocity Navigator::State::command(const geometry::Velocity& wanted) {
  const GuardVerdict verdict = guard.judge(wanted, now_ns);
  status.free_ahead_m = verdict.free_way_m;
  const bool stops = wanted.linear_m_per_s > 0.0 && verdict.allowed == geometry::Velocity{};
  if (stops && !guard_stop_ns) {
    guard_stop_ns = now_ns;
    ++status.guard_stops;
  } else if (!stops && wanted != geometry::Velocity{}) {
    guard_stop_ns.reset();
  }
  if (stops && verdict.contact_m && status.T_map_robot) {
    contacts.add(*status.T_map_robot * *verdict.contact_m, now_ns);
  }
  if (stops) status.message = verdict.message;
  status.command = verdict.allowed;
  follower.commanded(verdict.allowed, now_ns);
  if (const auto odometry = keeper.T_odom_robot(now_ns)) {
    stuck = base_watch.stuck(verdict.allowed, *odometry, now_ns);
  }
  return verdict.allowed;
}

HaltReason Navigator::State::halted(std::string& message) {
  if (paused) {
    message = "paused; drives on when told to resume";
    return HaltReason::kPaused;
  }
  if (!keeper.has_odometry(now_ns)) {
    message = say("no odometry for more than %.1f s", config.oldest_odometry_s);
    return HaltReason::kNoOdometry;
  }
  if (base && !base->commands_taken) {
    message = "the base takes no commands: " + base->reason;
    return HaltReason::kBaseNotReady;
  }
  if (stuck) {
    message = say("told to move for %.1f s, the base did not; drives on when told to resume",
                  config.stuck_s);
    return HaltReason::kBaseStuck;
  }
  return guard.health(now_ns, &message);
}

void Navigator::State::use_scan() {
  for (const ScanPoints& scan : scans) {
    if (!map || !status.T_map_robot) break;
    const auto T_map_robot = keeper.T_map_robot(scan.stamp_ns);
    if (!T_map_robot) continue;
    memory.add(scan, *T_map_robot, map->space());
    blockade.see(scan, *T_map_robot);
  }
  scans.clear();
  blockade.expire(now_ns);
}

void Navigator::State::forget_obstacles() {
  memory.clear();
  contacts.clear();
}

void Navigator::State::note_pose_jump() {
  constexpr double kMemory_m = 0.15;
  constexpr double kRoute_m = 0.5;
  const double jump_m = keeper.take_jump_m();
  if (jump_m > kMemory_m) forget_obstacles();
  if (jump_m > kRoute_m) lost = true;
}

// Routes of a map that is to come wait for it. Those of an older map are good where the new one has
// room for them; what an older map has no route for, the planner is asked again by the new one.
bool Navigator::State::usable(const RoutePlan& route) const {
  if (route.map_version > map_version) return false;
  if (reported && route.blockages_version < blockade.report().version) return false;
  return route.map_version == map_version || (route.found && way.fits(route));
}

void Navigator::State::use_route() {
  if (!offered || !map || !usable(*offered)) return;
  const RoutePlan route = *std::exchange(offered, std::nullopt);
  if (!route.found || route.points_m.empty()) {
    refused = route.reason.empty() ? "the planner has no route" : route.reason;
    way.forget();
    follower.forget();
    return;
  }
  const bool same_goal = way.has_route() && (way.goal_m() - route.points_m.back()).norm() < 0.01 &&
                         way.route().heading_rad == route.heading_rad;
  // The same way again, from a little further on: nothing changes for who is on it.
  const bool same_way =
      same_goal && !needs_path && !follower.path().empty() && !reported &&
      std::all_of(route.points_m.begin(), route.points_m.end(), [&](const auto& point_m) {
        constexpr double kSame_m = 0.35;
        return distance_m(follower.path(), point_m) < kSame_m;
      });
  if (!way.take(route)) {
    refused = "the planner's route is not on the map";
    return;
  }
  refused.clear();
  waits_route_ns.reset();
  if (same_way || (same_goal && settle_ns)) return;
  ++status.routes;
  reported = false;
  blocked_ns.reset();
  guard_stop_ns.reset();
  lost = false;
  needs_path = true;
  settle_ns.reset();
  corrections = 0;
  looks = 0;
}

geometry::Velocity Navigator::State::relocalize() {
  lost = true;
  needs_path = true;
  forget_obstacles();
  const std::string why = keeper.why_not(now_ns);
  const auto odometry = keeper.T_odom_robot(now_ns);
  if (status.reason != HaltReason::kPoseLost) {
    lost_ns = now_ns;
    look_around.reset();
  }
  // A pose that is only unsure is mostly right, and one turn on the spot makes it sure.
  const bool may_turn = goal.look_around || (keeper.doubtful() && !look_around.been_round());
  if (!may_turn || config.look_around_m <= 0.0 || !odometry) {
    return stop(NavigatorState::kRelocalizing, HaltReason::kPoseLost, why);
  }
  constexpr double kStandsFirst_s = 1.0;
  const double waited_s = since_s(lost_ns);
  if (waited_s < kStandsFirst_s || look_around.finished()) {
    const bool finished = look_around.finished();
    return stop(NavigatorState::kRelocalizing, HaltReason::kPoseLost,
                finished
                    ? say("%s; looked around on %.1f m in vain", why.c_str(), look_around.gone_m())
                    : why);
  }
  status.state = NavigatorState::kRelocalizing;
  status.reason = HaltReason::kPoseLost;
  status.message = say("%s; looks around, %.1f of %.1f m", why.c_str(), look_around.gone_m(),
                       config.look_around_m);
  return command(look_around.step(*odometry, guard, now_ns));
}

geometry::Velocity Navigator::State::step(std::int64_t at_ns) {
  now_ns = std::max(now_ns, at_ns);
  status.driven_m += has_goal ? keeper.take_driven_m() : 0.0;
  use_markov();
  status.T_map_robot = keeper.good_pose(now_ns);
  note_pose_jump();
  use_scan();
  if (arrived) return stop(NavigatorState::kArrived, HaltReason::kNone, status.message);
  if (!has_goal) {
    return cancelled ? stop(NavigatorState::kIdle, HaltReason::kCancelled, "cancelled")
                     : stop(NavigatorState::kIdle, HaltReason::kNone, "no goal");
  }
  std::string message;
  const HaltReason reason = halted(message);
  if (reason != HaltReason::kNone) {
    needs_path = true;
    settle_ns.reset();
    guard_stop_ns.reset();
    return stop(NavigatorState::kStopped, reason, std::move(message));
  }
  if (!status.T_map_robot) return relocalize();
  if (!map) return stop(NavigatorState::kStopped, HaltReason::kNoMap, "no map has come yet");
  const geometry::Pose2 pose = *status.T_map_robot;
  if (!map->frame().cell_of(pose.position_m())) {
    return stop(NavigatorState::kStopped, HaltReason::kOutsideMap,
                say("the robot is at %.2f, %.2f, which is not on the map", pose.x_m, pose.y_m));
  }
  use_route();
  if (!way.has_route()) return without_route();
  return drive(pose);
}

}  // namespace topogeo::navigation
