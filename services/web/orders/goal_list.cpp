#include "orders/goal_list.hpp"

#include <utility>

namespace topogeo::web {

bool GoalList::add(std::deque<Goal> goals, bool append) {
  if (!append) clear();
  for (Goal& goal : goals) waiting_.push_back(std::move(goal));
  if (current_ || waiting_.empty()) return false;
  current_ = std::move(waiting_.front());
  waiting_.pop_front();
  taken_ = false;
  missed_ = 0;
  return true;
}

void GoalList::clear() {
  current_.reset();
  waiting_.clear();
  taken_ = false;
}

std::optional<GoalList::End> GoalList::take(const msg::NavigatorStatus& status, bool held) {
  if (!current_) return std::nullopt;
  if (status.goal_id() == current_->id) {
    taken_ = true;
    if (status.reason() == msg::kHaltCancelled) {
      clear();
      return End::kTakenOver;
    }
    if (status.state() != msg::kNavigatorArrived) return std::nullopt;
    const bool waits = held || status.reason() == msg::kHaltPaused;
    if (waits && !waiting_.empty()) return std::nullopt;
    current_.reset();
    taken_ = false;
    static_cast<void>(add({}, true));
    return End::kArrived;
  }
  // Until the navigator takes the goal, its status refers to the previous one.
  if (!taken_ && ++missed_ < kPatience) return std::nullopt;
  const End end = taken_ ? End::kTakenOver : End::kNotTaken;
  clear();
  return end;
}

}  // namespace topogeo::web
