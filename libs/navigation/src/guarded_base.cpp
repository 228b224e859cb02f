#include "guarded_base.hpp"

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {

GuardedBase::GuardedBase(const GuardConfig& guard, double stuck_s)
    : stuck_s_(stuck_s),
      outlined_(plans_poses(guard)),
      guard_(guard),
      near_(guard),
      watch_(stuck_s) {}

void GuardedBase::add(const OdometrySample& odometry) {
  guard_.add(odometry);
  near_.add(odometry);
  odometry_ns_ = odometry.stamp_ns;
}

void GuardedBase::add(const SonarRound& sonar) {
  guard_.add(sonar);
  near_.add(sonar);
}

void GuardedBase::set(const MachineLoad& load, std::int64_t now_ns) {
  if (load.busy) {
    busy_ns_ = now_ns;
    if (stuck_ns_) judge_try(now_ns);
  } else if (tries_again_) {
    ++tries_;
    retry_now();
  }
}

HaltReason GuardedBase::halted(std::int64_t now_ns, std::string& message) const {
  if (base_ && !base_->commands_taken) {
    message = "the drive unit takes no orders: " + base_->reason;
    return HaltReason::kBaseNotReady;
  }
  if (!stopped_.empty()) {
    message = "the drive unit takes no orders: " + stopped_;
    return HaltReason::kBaseNotReady;
  }
  if (stuck_ns_) {
    message = fmt::format(
        "no motion after {:.1f} s of commands; {}", stuck_s_,
        tries_again_ ? "tries again when this machine is less busy" : "drives on after a resume");
    return HaltReason::kBaseStuck;
  }
  return guard_.health(now_ns, &message);
}

GuardedBase::Command GuardedBase::command(const geometry::Velocity& wanted,
                                          const std::optional<geometry::Pose2>& T_odom_robot,
                                          std::int64_t now_ns) {
  Command command;
  command.verdict = guard_.judge(near_.make_room(wanted, now_ns), now_ns);
  // Without room to move off, it only turns.
  if (command.verdict.allowed == geometry::Velocity{})
    command.verdict = guard_.judge(wanted, now_ns);
  const geometry::Velocity& allowed = command.verdict.allowed;
  const bool moves = outlined_ ? wanted != geometry::Velocity{} : wanted.linear_m_per_s > 0.0;
  command.stopped = moves && allowed == geometry::Velocity{};
  if (command.stopped && !stopped_ns_) {
    stopped_ns_ = now_ns;
    command.newly_stopped = true;
  } else if (!command.stopped && wanted != geometry::Velocity{}) {
    stopped_ns_.reset();
  }
  if (T_odom_robot) watch_motion(allowed, *T_odom_robot, now_ns);
  return command;
}

void GuardedBase::watch_motion(const geometry::Velocity& ordered,
                               const geometry::Pose2& T_odom_robot, std::int64_t now_ns) {
  constexpr double kMoved_m = 0.05;  // more than the play of the wheels
  if (tries_ > 0 && between(T_odom_stuck_, T_odom_robot).position_m().norm() > kMoved_m) tries_ = 0;
  stuck_ns_.reset();
  if (!watch_.stuck(ordered, T_odom_robot, odometry_ns_, now_ns)) return;
  T_odom_stuck_ = T_odom_robot;
  stuck_ns_ = now_ns;
  judge_try(now_ns);
}

// Load is measured over spans of a second, so it may be known only after the base is stuck.
void GuardedBase::judge_try(std::int64_t now_ns) {
  constexpr double kSpan_s = 1.2;  // with the delay of its timer
  if (elapsed_s(*stuck_ns_, now_ns) > kSpan_s || tries_ >= kTries || !busy_ns_) return;
  tries_again_ = tries_again_ || elapsed_s(*busy_ns_, *stuck_ns_) <= stuck_s_;
}

bool GuardedBase::held(std::int64_t now_ns) const {
  constexpr double kPatience_s = 0.7;  // less than any sensible obstacle_wait_s
  return stopped_ns_ && elapsed_s(*stopped_ns_, now_ns) > kPatience_s;
}

void GuardedBase::retry() {
  tries_ = 0;
  retry_now();
}

void GuardedBase::stay_stuck() {
  stuck_ns_ = 0;
  tries_again_ = false;
  tries_ = kTries;
}

void GuardedBase::retry_now() {
  stuck_ns_.reset();
  tries_again_ = false;
  watch_.reset();
}

}  // namespace topogeo::navigation
