// Works on match tasks in several threads, the slots of a worker.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/search_pool/fair_queue.hpp"
#include "topogeo/search_pool/match_job.hpp"
#include "topogeo/search_pool/slot_matchers.hpp"

namespace topogeo::search_pool {

/// CPU scheduling of the searching threads (Linux, sched(7)).
enum class SlotScheduling : std::uint8_t {
  kNormal,
  kBatch,  ///< the same share, but a starting search does not interrupt running threads
  kIdle,   ///< any other thread runs first, at once; on a machine that is busy without searches
           ///< they hardly progress
};

/// Thread-safe. Clients are served in turn; slots share only a queue.
class TaskRunner {
 public:
  struct Outcome {
    std::uint64_t ticket = 0;
    bool failed = false;
    std::string message;               ///< reason of the failure
    localization::MatchResult result;  ///< unless failed
  };
  /// Called in the thread of the slot; must not throw.
  using OutcomeHandler = std::function<void(Outcome outcome)>;

  /// Starts `slots` (>= 1) threads. Each keeps about `bytes_per_slot` of data from local maps. If
  /// the system refuses the `scheduling`, it stays normal.
  TaskRunner(std::size_t slots, std::size_t bytes_per_slot, SlotScheduling scheduling,
             OutcomeHandler on_outcome);
  TaskRunner(const TaskRunner&) = delete;
  TaskRunner& operator=(const TaskRunner&) = delete;
  /// Finishes running jobs and drops waiting ones.
  ~TaskRunner();

  void add(ReadyJob job);
  /// Removes the jobs of a client that no slot has started.
  void remove(const std::string& client_id);

  /// Number of jobs without an outcome.
  [[nodiscard]] std::size_t in_hand() const;
  /// Total time that slots have spent on jobs, including running ones.
  [[nodiscard]] std::chrono::nanoseconds busy_time() const;

 private:
  using Clock = std::chrono::steady_clock;

  void work(std::size_t slot);
  /// Waits for a job; empty when stopping.
  std::optional<ReadyJob> next_job(std::size_t slot);
  static Outcome solve(SlotMatchers& matchers, const ReadyJob& job);

  std::size_t bytes_per_slot_;
  SlotScheduling scheduling_;
  OutcomeHandler on_outcome_;
  mutable std::mutex mutex_;  // guards everything below except the threads
  std::condition_variable changed_;
  FairQueue<ReadyJob> queue_;
  std::size_t in_hand_ = 0;
  std::chrono::nanoseconds busy_{0};
  std::vector<std::optional<Clock::time_point>> started_;  // start of the running job, by slot
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace topogeo::search_pool
