#include "topogeo/search_pool/outcome_queue.hpp"

#include <utility>

namespace topogeo::search_pool {

OutcomeQueue::OutcomeQueue(std::function<void()> wake) : wake_(std::move(wake)) {}

void OutcomeQueue::add(TaskRunner::Outcome outcome) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(outcome));
    if (!claim_wake()) return;
  }
  wake_();
}

std::vector<TaskRunner::Outcome> OutcomeQueue::take() {
  const std::lock_guard lock(mutex_);
  woken_ = false;
  return std::exchange(waiting_, {});
}

void OutcomeQueue::wake_at(std::size_t outcomes) {
  {
    const std::lock_guard lock(mutex_);
    wake_at_ = outcomes;
    if (!claim_wake()) return;
  }
  wake_();
}

bool OutcomeQueue::claim_wake() {
  if (woken_ || waiting_.empty() || waiting_.size() < wake_at_) return false;
  woken_ = true;
  return true;
}

}  // namespace topogeo::search_pool
