#include "guarded_base.hpp"

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {

GuardedBase::GuardedBase(const GuardConfig& guard, double stuck_s)
    : stuck_s_(stuck_s), guard_(guard), near_(guard), watch_(stuck_s) {}

void GuardedBase::add(const OdometrySample& odometry) {
  guard_.add(odometry);
  near_.add(odometry);
  odometry_ns_ = odometry.stamp_ns;
}

void GuardedBase::add(const SonarRound& sonar) {
  guard_.add(sonar);
  near_.add(sonar);
}

HaltReason GuardedBase::halted(std::int64_t now_ns, std::string& message) const {
  if (base_ && !base_->commands_taken) {
    message = "the base takes no commands: " + base_->reason;
    return HaltReason::kBaseNotReady;
  }
  if (stuck_) {
    message = fmt::format(
        "ordered to move for {:.1f} s, the base did not; drives on after a resume", stuck_s_);
    return HaltReason::kBaseStuck;
  }
  return guard_.health(now_ns, &message);
}

GuardedBase::Command GuardedBase::command(const geometry::Velocity& wanted,
                                          const std::optional<geometry::Pose2>& T_odom_robot,
                                          std::int64_t now_ns) {
  Command command;
  command.verdict = guard_.judge(near_.make_room(wanted, now_ns), now_ns);
  // It turns where there is no room to move off, too.
  if (command.verdict.allowed == geometry::Velocity{})
    command.verdict = guard_.judge(wanted, now_ns);
  const geometry::Velocity& allowed = command.verdict.allowed;
  command.stopped = wanted.linear_m_per_s > 0.0 && allowed == geometry::Velocity{};
  if (command.stopped && !stopped_ns_) {
    stopped_ns_ = now_ns;
    command.newly_stopped = true;
  } else if (!command.stopped && wanted != geometry::Velocity{}) {
    stopped_ns_.reset();
  }
  if (T_odom_robot) stuck_ = watch_.stuck(allowed, *T_odom_robot, odometry_ns_, now_ns);
  return command;
}

bool GuardedBase::held(std::int64_t now_ns) const {
  constexpr double kPatience_s = 0.7;  // less than any obstacle_wait_s that makes sense
  return stopped_ns_ && elapsed_s(*stopped_ns_, now_ns) > kPatience_s;
}

void GuardedBase::retry() {
  stuck_ = false;
  watch_.reset();
}

}  // namespace topogeo::navigation
