#include "topogeo/navigation/navigator.hpp"

#include <utility>

#include "navigation_step.hpp"

namespace topogeo::navigation {

struct Navigator::State : NavigationStep {
  using NavigationStep::NavigationStep;
};

Navigator::Navigator(const NavigatorConfig& config) : state_(std::make_unique<State>(config)) {}
Navigator::~Navigator() = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

void Navigator::set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version) {
  State& state = *state_;
  const bool on_map = state.routes.set_map(std::move(map), version);
  const planning::HybridMap* now = state.routes.map();
  state.surroundings.forget();
  state.poses.set_map(now);
  state.limits = now != nullptr ? DrawnLimits(now->space()) : DrawnLimits();
  if (now == nullptr) {
    state.driver.forget();
    return;
  }
  if (!state.routes.has_route()) return;
  const PathFollower& follower = state.driver.follower();
  if (on_map && follower.has_path() &&
      passable(*state.routes.space(), follower.path(), follower.progress_m())) {
    return;
  }
  state.routes.drop(state.now_ns);
  state.driver.forget();
}

void Navigator::set_goal(const GoalOrder& goal) {
  State& state = *state_;
  state.goal.set(goal);
  state.routes.expect(state.now_ns);
  state.driver.forget();
  state.driver.trust_route();
  state.base.retry();
  state.base.release();
  state.wait.forget();
  state.arrival.reset();
  state.surroundings.forget_contacts();
  state.poses.take_driven_m();
  state.status = {};
  state.status.goal_id = goal.goal_id;
  state.status.state = NavigatorState::kStopped;
  state.status.reason = HaltReason::kWaitsForRoute;
  state.status.message = "waits for the planner";
}

void Navigator::set_route(const RoutePlan& route) {
  const auto& order = state_->goal.order();
  if (order && route.goal_id == order->goal_id) state_->routes.offer(route);
}

void Navigator::cancel() {
  if (!state_->goal.cancel()) return;
  state_->routes.cancel();
  state_->driver.forget();
}

void Navigator::pause() {
  state_->goal.pause();
}

void Navigator::resume() {
  state_->goal.resume();
  state_->base.retry();
}

void Navigator::set_stopped(std::string why) {
  state_->base.set_stopped(std::move(why));
}

bool Navigator::is_stuck() const {
  return state_->base.is_stuck();
}

void Navigator::stay_stuck() {
  state_->base.stay_stuck();
}

void Navigator::stay_arrived(const std::string& message) {
  State& state = *state_;
  if (!state.goal.order()) return;
  state.goal.arrive();
  state.status.state = NavigatorState::kArrived;
  state.status.reason = HaltReason::kNone;
  state.status.message = message;
}

void Navigator::add(const PoseFix& pose) {
  state_->poses.add(pose);
}

void Navigator::add(const OdometrySample& odometry) {
  state_->poses.add(odometry);
  state_->base.add(odometry);
}

void Navigator::add(const ScanPoints& scan) {
  state_->base.add(scan);
  state_->poses.add(scan);
  state_->surroundings.add(scan);
}

void Navigator::add(const SonarRound& sonar) {
  state_->base.add(sonar);
  state_->poses.add(sonar);
}

void Navigator::add(const LaserFields& fields) {
  state_->base.add(fields);
}

void Navigator::add(const BaseCondition& base) {
  state_->base.add(base);
}

void Navigator::note_arrival(TimedInput input, std::int64_t stamp_ns, std::int64_t arrival_ns) {
  state_->delays.add(input, stamp_ns, arrival_ns);
}

void Navigator::set_machine(const MachineLoad& load) {
  state_->delays.set(load);
  state_->base.set(load, state_->now_ns);
}

geometry::Velocity Navigator::step(std::int64_t now_ns) {
  return state_->step(now_ns);
}

const NavigatorStatus& Navigator::status() const {
  return state_->status;
}

const std::optional<PoseFix>& Navigator::markov_pose() const {
  return state_->poses.markov_pose();
}

const BlockageReport& Navigator::blockages() const {
  return state_->surroundings.blockages();
}

}  // namespace topogeo::navigation
