#include "orders/goal_rounds.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace topogeo::web {

void GoalRounds::begin(std::deque<Goal> goals, std::uint32_t rounds) {
  goals_ = std::move(goals);
  rounds_ = rounds;
  begun_ = 1;
}

std::deque<Goal> GoalRounds::next() {
  if (rounds_ != kEndless && begun_ >= rounds_) return {};
  ++begun_;
  std::deque<Goal> goals = goals_;
  for (Goal& goal : goals) goal.round = begun_;
  return goals;
}

bool GoalWait::holds(const Goal& goal, std::int64_t now_ns) {
  if (goal.id != goal_) {
    goal_ = goal.id;
    until_ns_ = now_ns + std::llround(goal.wait_s * 1e9);
  }
  return now_ns < until_ns_;
}

double GoalWait::rest_s(std::int64_t now_ns) const {
  return static_cast<double>(std::max<std::int64_t>(0, until_ns_ - now_ns)) / 1e9;
}

}  // namespace topogeo::web
