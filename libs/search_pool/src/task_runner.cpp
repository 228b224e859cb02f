#include "topogeo/search_pool/task_runner.hpp"

#include <exception>
#include <stdexcept>
#include <utility>

#include <sched.h>

namespace topogeo::search_pool {

namespace {

void schedule_this_thread(SlotScheduling scheduling) {
  if (scheduling == SlotScheduling::kNormal) return;
  const int policy = scheduling == SlotScheduling::kIdle ? SCHED_IDLE : SCHED_BATCH;
  const sched_param priority{};
  static_cast<void>(sched_setscheduler(0, policy, &priority));  // 0: this thread
}

}  // namespace

TaskRunner::TaskRunner(std::size_t slots, std::size_t bytes_per_slot, SlotScheduling scheduling,
                       OutcomeHandler on_outcome)
    : bytes_per_slot_(bytes_per_slot),
      scheduling_(scheduling),
      on_outcome_(std::move(on_outcome)),
      started_(slots) {
  if (slots == 0) throw std::invalid_argument("slots: 0, expected 1 or more");
  threads_.reserve(slots);
  for (std::size_t i = 0; i < slots; ++i) threads_.emplace_back([this, i] { work(i); });
}

TaskRunner::~TaskRunner() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void TaskRunner::add(ReadyJob job) {
  {
    const std::lock_guard lock(mutex_);
    ++in_hand_;
    const std::string client_id = job.job.client_id;
    queue_.push(client_id, std::move(job));
  }
  changed_.notify_one();
}

void TaskRunner::remove(const std::string& client_id) {
  const std::lock_guard lock(mutex_);
  in_hand_ -= queue_.remove(client_id).size();
}

std::size_t TaskRunner::in_hand() const {
  const std::lock_guard lock(mutex_);
  return in_hand_;
}

std::chrono::nanoseconds TaskRunner::busy_time() const {
  const std::lock_guard lock(mutex_);
  std::chrono::nanoseconds busy = busy_;
  const Clock::time_point now = Clock::now();
  for (const auto& start : started_) {
    if (start) busy += now - *start;
  }
  return busy;
}

std::optional<ReadyJob> TaskRunner::next_job(std::size_t slot) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
  if (stopping_) return {};
  started_[slot] = Clock::now();
  return queue_.pop();
}

void TaskRunner::work(std::size_t slot) {
  schedule_this_thread(scheduling_);
  SlotMatchers matchers(bytes_per_slot_);
  while (const std::optional<ReadyJob> job = next_job(slot)) {
    Outcome outcome = solve(matchers, *job);
    {
      const std::lock_guard lock(mutex_);
      --in_hand_;
      busy_ += Clock::now() - *started_[slot];
      started_[slot].reset();
    }
    on_outcome_(std::move(outcome));
  }
}

TaskRunner::Outcome TaskRunner::solve(SlotMatchers& matchers, const ReadyJob& job) {
  Outcome outcome;
  outcome.ticket = job.job.ticket;
  try {
    outcome.result = matchers.solve(job);
  } catch (const std::exception& error) {
    outcome.failed = true;
    outcome.message = error.what();
  }
  return outcome;
}

}  // namespace topogeo::search_pool
