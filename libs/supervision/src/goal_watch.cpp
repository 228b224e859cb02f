#include "topogeo/supervision/goal_watch.hpp"

namespace topogeo::supervision {
namespace {

using navigation::HaltReason;
using navigation::NavigatorState;
using navigation::NavigatorStatus;

/// A navigator publishes its status five times a second, so fifty are missing by then.
constexpr double kSilent_s = 10.0;
/// A restarted navigator has no goal until it has read its memory file. After this time, the goal
/// was cancelled.
constexpr double kStartsAgain_s = 5.0;

std::string text_of(const NavigatorStatus& status) {
  return status.message.empty() ? "the navigator gave no reason" : status.message;
}

bool is_cancelled(const NavigatorStatus& status) {
  return status.state == NavigatorState::kIdle ||
         (status.state == NavigatorState::kStopped && status.reason == HaltReason::kCancelled);
}

}  // namespace

bool GoalWatch::was_taken_away() const {
  return replaced_ || (status_ && is_cancelled(*status_));
}

bool GoalWatch::in_hand() const {
  return status_ && !without_s_ && status_->state != NavigatorState::kArrived &&
         !is_cancelled(*status_);
}

void GoalWatch::add(const RouteAnswer& answer) {
  if (answer.goal_id == goal_id_) answer_ = answer;
}

double GoalWatch::pass_time(double now_s) {
  return clock_.advance(now_s, busy_ ? 0.0 : 1.0);
}

void GoalWatch::set_busy(bool busy, double now_s) {
  pass_time(now_s);
  busy_ = busy;
}

void GoalWatch::add(const NavigatorStatus& status, double now_s) {
  const double time_s = pass_time(now_s);
  alive_s_ = time_s;
  if (status.goal_id != goal_id_) {
    if (!taken_) return;
    if (!without_s_) without_s_ = time_s;
    replaced_ = status.goal_id != 0 || time_s - *without_s_ > kStartsAgain_s;
    return;
  }
  taken_ = true;
  replaced_ = false;
  without_s_.reset();
  if (status.state == NavigatorState::kDriving || status.reason == HaltReason::kPaused) {
    driven_s_ = time_s;
  }
  status_ = status;
}

std::optional<GoalEnd> GoalWatch::check(double now_s) {
  const double time_s = pass_time(now_s);
  if (replaced_) return GoalEnd{false, "another goal replaced it, or another program cancelled it"};
  if (status_) {
    if (std::optional<GoalEnd> end = judge(*status_)) return end;
  }
  if (time_s - alive_s_ > kSilent_s) return GoalEnd{false, "the navigator is gone"};
  if (time_s - driven_s_ <= patience_s_) return std::nullopt;
  if (!taken_) return GoalEnd{false, "the navigator does not take the goal"};
  return GoalEnd{false, text_of(*status_)};
}

std::optional<GoalEnd> GoalWatch::judge(const NavigatorStatus& status) const {
  if (status.state == NavigatorState::kArrived) return GoalEnd{true, ""};
  if (is_cancelled(status)) return GoalEnd{false, "the goal was cancelled"};
  if (status.state == NavigatorState::kStopped && status.reason == HaltReason::kNoRoute &&
      answer_.refused) {
    return GoalEnd{false,
                   "no route: " + (answer_.reason.empty() ? text_of(status) : answer_.reason)};
  }
  return std::nullopt;
}

}  // namespace topogeo::supervision
