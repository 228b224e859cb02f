#include "goal_choice.hpp"

#include <algorithm>

#include "topogeo/service/navigation_conversions.hpp"

namespace topogeo::planner {

bool GoalChoice::add(const msg::Goal& goal) {
  std::erase_if(given_, [&](const msg::Goal& other) { return other.goal_id() == goal.goal_id(); });
  given_.push_back(goal);
  if (given_.size() > kMost) given_.pop_front();
  if (in_hand_ && *in_hand_ != goal.goal_id()) return false;
  chosen_ = goal;
  return true;
}

void GoalChoice::cancel(const msg::Goal& order) {
  if (in_hand_ || !chosen_) return;
  if (order.goal_id() == 0 || order.goal_id() == chosen_->goal_id()) chosen_.reset();
}

bool GoalChoice::take(const msg::NavigatorStatus& status) {
  in_hand_ = service::goal_has_ended(status) ? 0 : status.goal_id();
  if (chosen_ && chosen_->goal_id() == *in_hand_) return false;
  chosen_.reset();
  const auto found = std::ranges::find_if(
      given_, [&](const msg::Goal& goal) { return goal.goal_id() == *in_hand_; });
  if (*in_hand_ == 0 || found == given_.end()) return false;
  chosen_ = *found;
  return true;
}

}  // namespace topogeo::planner
