// Driving: the path to follow, what is in its way, and waiting for it to go away.
#include <algorithm>
#include <cmath>
#include <utility>

#include "arc_sweep.hpp"
#include "navigator_state.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kSees_m = 2.5;       // what is further along the path does not matter yet
constexpr double kKeepsOff_m = 0.15;  // stops so far before the place where it would touch
constexpr double kWaiting_m_s = 0.05;
constexpr double kObstacleBrake = 0.6;  // of the acceleration, when something is in the way
constexpr double kSeeing_s = 0.15;      // from a measurement until a command follows, about
constexpr double kProgress_m = 0.1;  // so far on, and it does not wait for that obstacle any more
constexpr double kWaiting_rad_s = 0.1;
constexpr double kPlanEvery_s = 0.3;
constexpr double kNearEnough_m = 0.08;  // a goal that is too narrow for the last centimetres
constexpr double kGuardWaits_s = 0.7;  // stopped by the guard for so long, it looks for a way round

}  // namespace

geometry::Velocity Navigator::State::without_route() {
  if (!refused.empty()) {
    const bool by_obstacle = !blockade.empty();
    return stop(by_obstacle ? NavigatorState::kBlocked : NavigatorState::kStopped,
                HaltReason::kNoRoute, refused);
  }
  const double waited_s = since_s(waits_route_ns.value_or(goal_ns));
  return stop(
      lost ? NavigatorState::kRelocalizing : NavigatorState::kStopped, HaltReason::kWaitsForRoute,
      waited_s < config.route_wait_s ? "waits for the planner"
                                     : say("the planner has not answered for %.0f s", waited_s));
}

SeenObstacles Navigator::State::seen() const {
  SeenObstacles seen;
  const std::vector<Obstacle> obstacles = memory.all();
  for (const Obstacle& obstacle : obstacles) {
    if (obstacle.stands) seen.points_m.push_back(obstacle.point_m);
  }
  const std::vector<Eigen::Vector2d> met_m = contacts.points_m(now_ns);
  seen.points_m.insert(seen.points_m.end(), met_m.begin(), met_m.end());
  seen.standing = seen.points_m.size();
  for (const Obstacle& obstacle : obstacles) {
    if (!obstacle.stands) seen.points_m.push_back(obstacle.point_m);
  }
  return seen;
}

bool Navigator::State::find_path(const geometry::Pose2& T_map_robot) {
  auto local = way.plan(T_map_robot.position_m(), seen().standing_m());
  planned_ns = now_ns;
  no_way_to_route = local.status == planning::DetourStatus::kLost;
  if (local.path.empty()) return false;
  // A long way round is taken when what is in the way has had its time to go away.
  constexpr double kLong_m = 2.0;
  const bool waited = blocked_ns && since_s(*blocked_ns) >= config.obstacle_wait_s;
  if (!needs_path && follower.has_path() && !waited &&
      local.path.back().distance_m > follower.rest_m() + kLong_m) {
    return false;
  }
  if (local.status == planning::DetourStatus::kFound) ++status.detours;
  markov.set_path(local.path, way.route().nodes_m);
  follower.follow(std::move(local.path), way.route().heading_rad);
  needs_path = false;
  lost = false;
  waits_route_ns.reset();
  return true;
}

geometry::Velocity Navigator::State::drive(const geometry::Pose2& T_map_robot) {
  constexpr double kStray_m = 0.5;
  if (const auto told = look()) return *told;
  if (settle_ns) return settle(T_map_robot);
  const bool strays =
      !follower.path().empty() && distance_m(follower.path(), T_map_robot.position_m()) > kStray_m;
  if (strays && !needs_path) {
    lost = true;
    needs_path = true;
  }
  // Far from its route it waits for one from where it is; if none comes, it goes back to the old.
  if (lost && strays) {
    if (!waits_route_ns) waits_route_ns = now_ns;
    if (since_s(*waits_route_ns) < config.route_wait_s) {
      return stop(NavigatorState::kRelocalizing, HaltReason::kWaitsForRoute,
                  "is not on its route; waits for another one");
    }
  }
  if (needs_path || !follower.has_path()) {
    const bool again = blocked_ns && since_s(planned_ns) < kPlanEvery_s;
    if (again || !find_path(T_map_robot)) return wait_for_obstacle();
  }
  return follow(T_map_robot);
}

geometry::Velocity Navigator::State::follow(const geometry::Pose2& T_map_robot) {
  const double limit = speed_past_obstacles(T_map_robot);
  if (guard_stop_ns && since_s(*guard_stop_ns) > kGuardWaits_s) go_round(T_map_robot);
  const FollowerStep order = follower.step(T_map_robot, now_ns, limit);
  const bool before_block = block_m && limit < kWaiting_m_s && order.rest_m > 0.0 &&
                            order.command.linear_m_per_s < kWaiting_m_s &&
                            std::fabs(order.command.angular_rad_per_s) < kWaiting_rad_s;
  const bool before_guard = guard_stop_ns && since_s(*guard_stop_ns) > kGuardWaits_s;
  if ((before_block || before_guard) &&
      (way.goal_m() - T_map_robot.position_m()).norm() < kNearEnough_m) {
    return settle_here();
  }
  if (before_block || before_guard) {
    begin_waiting();
  } else if (blocked_ns && status.driven_m > blocked_driven_m + kProgress_m) {
    blocked_ns.reset();
    reported = false;
  }
  if (order.done) {
    settle_ns = now_ns;
    looked_at_end = false;
    return settle(T_map_robot);
  }
  tell_driving(order);
  const geometry::Velocity told = command(order.command);
  if (before_block || before_guard) tell_waiting();
  return told;
}

void Navigator::State::tell_driving(const FollowerStep& order) {
  status.state = NavigatorState::kDriving;
  status.reason = HaltReason::kNone;
  status.rest_m = order.rest_m;
  status.rest_s = order.rest_s;
  status.message = say("drives, %.1f m to go", order.rest_m);
}

double Navigator::State::speed_past_obstacles(const geometry::Pose2& T_map_robot) {
  block_m.reset();
  const SeenObstacles seen_now = seen();
  const Eigen::Vector2d robot_m = T_map_robot.position_m();
  const auto look = [&](std::span<const Eigen::Vector2d> points_m) {
    return way.blocked(follower.path(), follower.progress_m(), robot_m, points_m, kSees_m);
  };
  auto block = look(seen_now.points_m);
  if (!block) return config.speed_m_per_s;
  if (since_s(planned_ns) > kPlanEvery_s && look(seen_now.standing_m())) {
    go_round(T_map_robot);
    block = look(seen_now.points_m);
    if (!block) return config.speed_m_per_s;
  }
  block_m = block->obstacle_m;
  block_ahead_m = block->ahead_m;
  return std::min(config.speed_m_per_s,
                  stopping_speed(block->ahead_m - kKeepsOff_m, config.delay_s + kSeeing_s,
                                 kObstacleBrake * config.acceleration_m_per_s2));
}

// Another path, when there is one; the old one stays otherwise.
void Navigator::State::go_round(const geometry::Pose2& T_map_robot) {
  if (since_s(planned_ns) < kPlanEvery_s) return;
  if (find_path(T_map_robot)) guard_stop_ns.reset();
}

void Navigator::State::begin_waiting() {
  if (blocked_ns) return;
  blocked_ns = now_ns;
  blocked_driven_m = status.driven_m;
}

geometry::Velocity Navigator::State::wait_for_obstacle() {
  begin_waiting();
  tell_waiting();
  return stop(status.state, status.reason, status.message);
}

void Navigator::State::tell_waiting() {
  const double waited_s = since_s(*blocked_ns);
  if (!reported && waited_s >= config.obstacle_wait_s + kPlanEvery_s) report_blockage();
  const std::string what = block_m ? say("something is in the way %.1f m ahead", block_ahead_m)
                           : no_way_to_route ? "no way leads from here to the route"
                                             : "the way is blocked";
  status.state = NavigatorState::kBlocked;
  status.reason = reported ? HaltReason::kWaitsForRoute : HaltReason::kObstacle;
  if (!reported) {
    status.message = say("%s; waits %.0f s, then looks for another route", what.c_str(),
                         std::max(0.0, config.obstacle_wait_s - waited_s));
  } else if (since_s(reported_ns) < config.route_wait_s) {
    status.message = what + "; asks for another route";
  } else {
    status.message =
        say("%s; the planner has not answered for %.0f s", what.c_str(), since_s(reported_ns));
  }
}

void Navigator::State::report_blockage() {
  constexpr double kAround_m = 1.0;
  std::vector<Eigen::Vector2d> filled_m;
  const auto& pose = status.T_map_robot;
  const Eigen::Vector2d around_m =
      block_m ? *block_m : (pose ? pose->position_m() : Eigen::Vector2d::Zero());
  const double reach_m = block_m ? kAround_m : config.detour.half_side_m;
  for (const Eigen::Vector2d& point_m : seen().points_m) {
    if ((point_m - around_m).norm() < reach_m) filled_m.push_back(point_m);
  }
  if (!blockade.add(filled_m, map->frame(), now_ns)) blockade.ask_again();
  reported = true;
  reported_ns = now_ns;
}

}  // namespace topogeo::navigation
