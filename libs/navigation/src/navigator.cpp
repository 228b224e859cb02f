#include "topogeo/navigation/navigator.hpp"

#include <utility>

#include "navigator_state.hpp"
#include "settings_check.hpp"

namespace topogeo::navigation {
namespace {

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

NavigatorConfig checked(const NavigatorConfig& config) {
  check(config);
  return config;
}

}  // namespace

void check(const NavigatorConfig& config) {
  const auto range = [](const char* field, double value, double low, double high) {
    check_range("navigator", field, value, low, high);
  };
  range("settle_s", config.settle_s, 0.0, 10.0);
  range("oldest_pose_s", config.oldest_pose_s, 0.1, 60.0);
  range("oldest_odometry_s", config.oldest_odometry_s, 0.1, 10.0);
  range("largest_sigma_m", config.largest_sigma_m, 0.05, 5.0);
  range("obstacle_wait_s", config.obstacle_wait_s, 0.0, 600.0);
  range("blockage_s", config.blockage_s, 1.0, 86400.0);
  range("route_wait_s", config.route_wait_s, 0.1, 600.0);
  range("stuck_s", config.stuck_s, 0.2, 60.0);
  range("look_around_m", config.look_around_m, 0.0, 50.0);
  check(follower_config(config));
  check(config.guard);
  check(config.markov);
  planning::check(config.detour);
  planning::check(config.smooth);
}

Navigator::State::State(const NavigatorConfig& settings)
    : config(checked(settings)),
      guard(settings.guard),
      keeper({settings.oldest_pose_s, settings.oldest_odometry_s, settings.largest_sigma_m}),
      follower(follower_config(settings)),
      memory(MemoryConfig{}),
      way(config),
      base_watch(settings.stuck_s),
      look_around(settings.look_around_m),
      blockade(settings.blockage_s),
      markov(config) {}

Navigator::Navigator(const NavigatorConfig& config) : state_(std::make_unique<State>(config)) {}
Navigator::~Navigator() = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

void Navigator::set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version) {
  State& state = *state_;
  state.map = std::move(map);
  state.map_version = version;
  state.way.set_map(state.map);
  state.forget_obstacles();
  state.markov.set_map(state.map.get());
  if (!state.map) {
    state.way.forget();
    state.follower.forget();
    return;
  }
  // The cells of the route are counted anew; a route that the new map has no room for is none.
  if (!state.way.has_route()) return;
  const RoutePlan route = state.way.route();
  const bool passable = state.way.take(route) && state.follower.has_path() &&
                        state.way.passable(state.follower.path(), state.follower.progress_m());
  if (passable) return;
  state.way.forget();
  state.follower.forget();
  state.waits_route_ns = state.now_ns;
}

void Navigator::set_goal(const GoalOrder& goal) {
  State& state = *state_;
  state.goal = goal;
  state.has_goal = true;
  state.arrived = state.cancelled = state.paused = state.stuck = false;
  state.offered.reset();
  state.refused.clear();
  state.way.forget();
  state.follower.forget();
  state.base_watch.reset();
  state.look_around.reset();
  state.blocked_ns.reset();
  state.guard_stop_ns.reset();
  state.settle_ns.reset();
  state.waits_route_ns.reset();
  state.contacts.clear();
  state.reported = false;
  state.lost = false;
  state.corrections = 0;
  state.looks = 0;
  state.goal_ns = state.now_ns;
  state.keeper.take_driven_m();
  state.status = {};
  state.status.goal_id = goal.goal_id;
  state.status.state = NavigatorState::kStopped;
  state.status.reason = HaltReason::kWaitsForRoute;
  state.status.message = "waits for the planner";
}

void Navigator::set_route(const RoutePlan& route) {
  State& state = *state_;
  if (!state.has_goal || route.goal_id != state.goal.goal_id) return;
  state.offered = route;
}

void Navigator::cancel() {
  State& state = *state_;
  if (!state.has_goal) return;
  state.has_goal = false;
  state.arrived = false;
  state.cancelled = true;
  state.offered.reset();
  state.way.forget();
  state.follower.forget();
}

void Navigator::pause() {
  state_->paused = state_->has_goal;
}

void Navigator::resume() {
  state_->paused = false;
  state_->stuck = false;
  state_->base_watch.reset();
}

void Navigator::add(const PoseFix& pose) {
  if (state_->markov.on()) {
    state_->markov.add(pose);
  } else {
    state_->keeper.add(pose);
  }
}

void Navigator::add(const OdometrySample& odometry) {
  state_->keeper.add(odometry);
  state_->guard.add(odometry);
  state_->markov.add(odometry);
}

void Navigator::add(const ScanPoints& scan) {
  state_->guard.add(scan);
  state_->markov.add(scan);
  constexpr std::size_t kMost = 10;
  if (state_->scans.size() < kMost) state_->scans.push_back(scan);
}

void Navigator::add(const SonarRound& sonar) {
  state_->guard.add(sonar);
  state_->markov.add(sonar);
}

void Navigator::add(const BaseCondition& base) {
  state_->base = base;
}

geometry::Velocity Navigator::step(std::int64_t now_ns) {
  return state_->step(now_ns);
}

const NavigatorStatus& Navigator::status() const {
  return state_->status;
}

const BlockageReport& Navigator::blockages() const {
  return state_->blockade.report();
}

}  // namespace topogeo::navigation
