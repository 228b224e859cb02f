#include "goal_in_hand.hpp"

namespace topogeo::navigation {

void GoalInHand::set(const GoalOrder& goal) {
  *this = {};
  goal_ = goal;
}

bool GoalInHand::cancel() {
  if (!goal_) return false;
  goal_.reset();
  arrived_ = false;
  cancelled_ = true;
  return true;
}

}  // namespace topogeo::navigation
