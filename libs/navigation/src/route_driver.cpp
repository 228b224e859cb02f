#include "route_driver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/support/format.hpp"

#include "arc_sweep.hpp"
#include "elapsed.hpp"
#include "path_distance.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kSees_m = 2.5;         // what is further along the path does not matter yet
constexpr double kKeepsOff_m = 0.15;    // stops so far before the place where it would touch
constexpr double kWaiting_m_s = 0.05;   // slower counts as standing before an obstacle
constexpr double kWaiting_rad_s = 0.1;  // so does a slower turn
constexpr double kObstacleBrake = 0.6;  // of the acceleration, when something is in the way
constexpr double kSeeing_s = 0.15;      // from a measurement until a command follows, about

}  // namespace

FollowerConfig follower_config(const NavigatorConfig& config) {
  FollowerConfig follower;
  follower.speed_m_per_s = config.speed_m_per_s;
  follower.turn_rad_per_s = config.turn_rad_per_s;
  follower.acceleration_m_per_s2 = config.acceleration_m_per_s2;
  follower.turn_acceleration_rad_per_s2 = config.turn_acceleration_rad_per_s2;
  follower.delay_s = config.delay_s;
  follower.arrival_m = config.arrival_m;
  follower.arrival_rad = config.arrival_rad;
  if (config.motion == MotionStyle::kPrimitives) follower.begin_turn_rad = 0.05;
  return follower;
}

RouteDriver::RouteDriver(const NavigatorConfig& config)
    : config_(config), planner_(config), follower_(follower_config(config)) {}

bool RouteDriver::astray(const Eigen::Vector2d& robot_m) {
  constexpr double kStray_m = 0.5;  // following a path it is never that far from it
  if (follower_.path().empty() || distance_m(follower_.path(), robot_m) <= kStray_m) return false;
  if (!needs_path_) {
    doubts_route_ = true;
    needs_path_ = true;
  }
  return doubts_route_;
}

bool RouteDriver::just_planned(std::int64_t now_ns) const {
  return elapsed_s(planned_ns_, now_ns) < kPlanEvery_s;
}

bool RouteDriver::find_path(const Scene& scene) {
  LocalPath local =
      planner_.plan(scene.route, scene.T_map_robot.position_m(), scene.obstacles.standing_m());
  planned_ns_ = scene.now_ns;
  cut_off_ = local.status == planning::DetourStatus::kLost;
  if (local.path.empty()) return false;
  constexpr double kLong_m = 2.0;  // so much longer than the rest of the path is a long detour
  if (!needs_path_ && follower_.has_path() && !scene.waited &&
      local.path.back().distance_m > follower_.rest_m() + kLong_m) {
    return false;
  }
  if (local.status == planning::DetourStatus::kFound) ++detours_;
  follower_.follow(std::move(local.path), scene.route.route().heading_rad);
  needs_path_ = false;
  doubts_route_ = false;
  return true;
}

// Another path, when there is one; the old one stays otherwise.
bool RouteDriver::go_round(const Scene& scene) {
  return !just_planned(scene.now_ns) && find_path(scene);
}

double RouteDriver::speed_past_obstacles(const Scene& scene, bool& another_path) {
  block_.reset();
  const auto first_of = [&](std::span<const Eigen::Vector2d> points_m) {
    return planner_.blocked(follower_.path(), follower_.progress_m(),
                            scene.T_map_robot.position_m(), points_m, kSees_m);
  };
  auto block = first_of(scene.obstacles.points_m);
  if (!block) return config_.speed_m_per_s;
  if (elapsed_s(planned_ns_, scene.now_ns) > kPlanEvery_s &&
      first_of(scene.obstacles.standing_m())) {
    another_path = go_round(scene);
    block = first_of(scene.obstacles.points_m);
    if (!block) return config_.speed_m_per_s;
  }
  block_ = block;
  return std::min(config_.speed_m_per_s,
                  stopping_speed(block->ahead_m - kKeepsOff_m, config_.delay_s + kSeeing_s,
                                 kObstacleBrake * config_.acceleration_m_per_s2));
}

RouteDriver::Step RouteDriver::follow(const Scene& scene, bool held) {
  Step step;
  const double limit = speed_past_obstacles(scene, step.another_path);
  if (held && !step.another_path) step.another_path = go_round(scene);
  step.follower = follower_.step(scene.T_map_robot, scene.now_ns, limit);
  const geometry::Velocity& command = step.follower.command;
  step.before_block = block_ && limit < kWaiting_m_s && step.follower.rest_m > 0.0 &&
                      command.linear_m_per_s < kWaiting_m_s &&
                      std::fabs(command.angular_rad_per_s) < kWaiting_rad_s;
  return step;
}

std::string RouteDriver::describe_block() const {
  if (block_) return fmt::format("something is in the way {:.1f} m ahead", block_->ahead_m);
  return cut_off_ ? "no path leads from here to the route" : "the path is blocked";
}

}  // namespace topogeo::navigation
