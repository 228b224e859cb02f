#include "route_driver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/drive_time.hpp"
#include "topogeo/support/format.hpp"

#include "elapsed.hpp"
#include "outline_block.hpp"
#include "path_distance.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kSees_m = 2.5;         // farther parts of the path do not matter yet
constexpr double kKeepsOff_m = 0.15;    // stops this far before the place of contact
constexpr double kWaiting_m_s = 0.05;   // slower counts as standing before an obstacle
constexpr double kWaiting_rad_s = 0.1;  // so does a slower turn
constexpr double kObstacleBrake = 0.6;  // of the acceleration, for obstacles in the way
constexpr double kSeeing_s = 0.15;      // between a measurement and its command, approximately

}  // namespace

FollowerConfig follower_config(const NavigatorConfig& config) {
  FollowerConfig follower = config.follower;
  const bool exact = config.motion == MotionStyle::kPrimitives || plans_poses(config.guard);
  if (exact) follower.begin_turn_rad = 0.05;
  follower.minimum_radius_m = config.guard.minimum_turning_radius_m;
  return follower;
}

RouteDriver::RouteDriver(const NavigatorConfig& config)
    : config_(config),
      outline_(plans_poses(config.guard) ? outline_of(config.guard) : geometry::Footprint{}),
      planner_(config),
      follower_(follower_config(config)) {}

bool RouteDriver::astray(const Eigen::Vector2d& robot_m) {
  constexpr double kStray_m = 0.5;  // a follower always stays closer to its path
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

LocalPath RouteDriver::plan(const Scene& scene) const {
  const auto standing_m = scene.obstacles.standing_m();
  if (outline_.empty()) {
    return planner_.plan(scene.route, scene.T_map_robot.position_m(), standing_m,
                         scene.obstacles.scan);
  }
  // The route avoids what is reported, but the outline may need another way.
  std::vector<Eigen::Vector2d> obstacles_m(standing_m.begin(), standing_m.end());
  obstacles_m.insert(obstacles_m.end(), scene.reported_m.begin(), scene.reported_m.end());
  return planner_.plan_outline(scene.route, scene.T_map_robot, obstacles_m);
}

bool RouteDriver::find_path(const Scene& scene) {
  constexpr double kRefusedFor_s = 3.0;  // a search for an outline without a path takes long
  if (!refused_.empty() && elapsed_s(planned_ns_, scene.now_ns) < kRefusedFor_s) return false;
  LocalPath local = plan(scene);
  refused_ = std::move(local.refused);
  planned_ns_ = scene.now_ns;
  cut_off_ = local.status == planning::DetourStatus::kLost;
  if (local.path.empty()) return false;
  constexpr double kLong_m = 2.0;  // beyond the rest of the path: a long detour
  if (!needs_path_ && follower_.has_path() && !scene.waited &&
      local.path.back().distance_m > follower_.rest_m() + kLong_m) {
    return false;
  }
  if (local.status == planning::DetourStatus::kFound) ++detours_.all;
  if (local.on_branches) ++detours_.on_branches;
  if (local.on_virtual) ++detours_.on_virtual;
  const std::vector<double> limits = limits_along(*scene.route.space(), local.path);
  follower_.follow(std::move(local.path), scene.route.route().heading_rad, limits);
  needs_path_ = false;
  doubts_route_ = false;
  return true;
}

// Takes another path if there is one; otherwise keeps the old one.
bool RouteDriver::go_round(const Scene& scene) {
  return !just_planned(scene.now_ns) && find_path(scene);
}

double RouteDriver::speed_past_obstacles(const Scene& scene, bool& another_path) {
  block_.reset();
  const auto first_of = [&](std::span<const Eigen::Vector2d> points_m) {
    if (!outline_.empty()) {
      return outline_block(outline_, follower_.path(), follower_.progress_m(), scene.T_map_robot,
                           points_m, kSees_m);
    }
    return planner_.blocked(follower_.path(), follower_.progress_m(),
                            scene.T_map_robot.position_m(), points_m, kSees_m);
  };
  auto block = first_of(scene.obstacles.points_m);
  if (!block) return config_.follower.speed_m_per_s;
  if (elapsed_s(planned_ns_, scene.now_ns) > kPlanEvery_s &&
      first_of(scene.obstacles.standing_m())) {
    another_path = go_round(scene);
    block = first_of(scene.obstacles.points_m);
    if (!block) return config_.follower.speed_m_per_s;
  }
  block_ = block;
  return std::min(config_.follower.speed_m_per_s,
                  stopping_speed(block->ahead_m - kKeepsOff_m, config_.follower.delay_s + kSeeing_s,
                                 kObstacleBrake * config_.follower.acceleration_m_per_s2));
}

double RouteDriver::speed_in_zones(const Scene& scene) const {
  const planning::FreeSpace& space = *scene.route.space();
  double most = config_.follower.speed_m_per_s;
  if (!space.rules().guides()) return most;
  const double brake = kObstacleBrake * config_.follower.acceleration_m_per_s2;
  const auto consider = [&](const Eigen::Vector2d& point_m, double ahead_m) {
    const auto cell = space.frame().cell_of(point_m);
    const auto limit = cell ? space.rules().speed_mps(space.frame().index(*cell)) : std::nullopt;
    if (!limit) return;
    const double late_m = config_.follower.delay_s * most;
    most =
        std::min(most, std::sqrt(*limit * *limit + 2.0 * brake * std::max(0.0, ahead_m - late_m)));
  };
  consider(scene.T_map_robot.position_m(), 0.0);
  for (const planning::PathSample& sample : follower_.path()) {
    const double ahead_m = sample.distance_m - follower_.progress_m();
    if (ahead_m > 0.0 && ahead_m < kSees_m) consider(sample.T_map_robot.position_m(), ahead_m);
  }
  return most;
}

RouteDriver::Step RouteDriver::follow(const Scene& scene, bool held) {
  Step step;
  const double limit =
      std::min(speed_past_obstacles(scene, step.another_path), speed_in_zones(scene));
  if (held && !step.another_path) step.another_path = go_round(scene);
  step.follower = follower_.step(scene.T_map_robot, scene.now_ns, limit);
  if (step.follower.strayed) need_path();
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
