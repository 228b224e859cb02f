// What slots have finished, on its way to the loop of their worker.
#pragma once

#include <cstddef>
#include <functional>
#include <mutex>
#include <vector>

#include "topogeo/search_pool/task_runner.hpp"

namespace topogeo::search_pool {

/// Slots add, the loop takes. The loop is not woken for each outcome, which costs more than the
/// outcome itself, but when as many have come as it asked for. Safe to call from any thread.
class OutcomeQueue {
 public:
  /// `wake` is called in the thread that adds; it must see to it that take() is called soon.
  explicit OutcomeQueue(std::function<void()> wake);

  void add(TaskRunner::Outcome outcome);
  /// All that wait, oldest first.
  std::vector<TaskRunner::Outcome> take();
  /// Wakes when so many (>= 1, at first 1) wait, those that do already included.
  void wake_at(std::size_t outcomes);

 private:
  /// True for who is to wake: when it is time, and once until take().
  [[nodiscard]] bool claim_wake();

  std::function<void()> wake_;
  std::mutex mutex_;  // guards all below
  std::vector<TaskRunner::Outcome> waiting_;
  std::size_t wake_at_ = 1;
  bool woken_ = false;
};

}  // namespace topogeo::search_pool
