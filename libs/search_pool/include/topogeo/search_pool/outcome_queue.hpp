// Outcomes of slots on their way to the loop of their worker.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

#include "topogeo/search_pool/task_runner.hpp"

namespace topogeo::search_pool {

/// Slots add outcomes, the loop takes them. Waking the loop for each one would cost more than the
/// outcome itself, so it wakes for the number that it has asked for. Thread-safe.
class OutcomeQueue {
 public:
  /// `wake` is called in the thread that adds; it must cause a call of take() soon.
  explicit OutcomeQueue(std::function<void()> wake);

  void add(TaskRunner::Outcome outcome);
  /// Returns all waiting outcomes, oldest first.
  std::vector<TaskRunner::Outcome> take();
  /// Wakes when this many (>= 1, initially 1) wait, including those already waiting.
  void wake_at(std::size_t outcomes);

 private:
  /// True if the caller must wake: when enough are waiting, and once until take().
  [[nodiscard]] bool claim_wake();

  std::function<void()> wake_;
  std::mutex mutex_;  // guards all below
  std::vector<TaskRunner::Outcome> waiting_;
  std::size_t wake_at_ = 1;
  bool woken_ = false;
};

}  // namespace topogeo::search_pool
