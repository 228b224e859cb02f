#include "orders/unconfirmed_order.hpp"

#include "topogeo/service/navigation_conversions.hpp"

#include "orders/goal_list.hpp"

namespace topogeo::web {

void UnconfirmedOrder::begin(msg::GoalKind kind, std::uint64_t own_goal) {
  kind_ = kind;
  missed_ = 0;
  unseen_ = 0;
  awaited_ = in_hand_ == own_goal ? 0 : own_goal;
  goals_.clear();
  if (own_goal != 0) goals_.insert(own_goal);
  if (in_hand_) goals_.insert(*in_hand_);
  if (reached_ != 0) goals_.insert(reached_);
}

std::optional<UnconfirmedOrder::Repeat> UnconfirmedOrder::take(const msg::NavigatorStatus& status) {
  const bool known = in_hand_.has_value();
  in_hand_ = service::goal_has_ended(status) ? 0 : status.goal_id();
  reached_ = status.state() == msg::kNavigatorArrived ? status.goal_id() : 0;
  if (!kind_) return std::nullopt;
  const std::uint64_t goal = is_pause() && reached_ != 0 ? reached_ : *in_hand_;
  if (!known) goals_.insert(goal);
  if (status.goal_id() == awaited_ || ++unseen_ >= GoalList::kPatience) awaited_ = 0;
  const bool paused = is_pause() && status.reason() == msg::kHaltPaused;
  if (goal == 0 || !goals_.contains(goal) || paused) {
    const bool confirmed = paused || *in_hand_ != 0 || !is_pause();
    if (confirmed && awaited_ == 0) kind_.reset();
    return std::nullopt;
  }
  if (++missed_ % kStatuses != 0) return std::nullopt;
  return Repeat{*kind_, goal};
}

}  // namespace topogeo::web
