// Works on match tasks in several threads: the slots of a worker.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "topogeo/localization/match.hpp"
#include "topogeo/localization/matcher.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::ga_worker {

/// Safe to call from any thread.
class TaskRunner {
 public:
  struct Job {
    std::uint64_t ticket = 0;  ///< chosen by the caller, comes back with the outcome
    std::string robot_id;      ///< whose maps are meant
    localization::MatchTask task;
  };
  enum class Failure : std::uint8_t { kNone, kMapMissing, kFailed };
  struct Outcome {
    std::uint64_t ticket = 0;
    Failure failure = Failure::kNone;
    std::string message;               ///< why it failed
    localization::MatchResult result;  ///< if it did not
  };
  /// Called in the thread of the slot.
  using OutcomeHandler = std::function<void(Outcome outcome)>;

  /// Starts `slots` (>= 1) threads. A job whose maps are not there waits `map_patience` for them.
  TaskRunner(std::size_t slots, std::chrono::nanoseconds map_patience, OutcomeHandler on_outcome);
  TaskRunner(const TaskRunner&) = delete;
  TaskRunner& operator=(const TaskRunner&) = delete;
  /// Ends the jobs that run and drops those that wait.
  ~TaskRunner();

  /// Replaces an earlier map of that robot and id.
  void add_map(std::shared_ptr<const topomap::LocalMap> map);
  void add(Job job);

  /// Jobs without outcome.
  [[nodiscard]] std::size_t in_hand() const;
  [[nodiscard]] std::size_t maps_held() const;
  /// Sum of the time that slots have spent on jobs.
  [[nodiscard]] std::chrono::nanoseconds busy_time() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct HeldMap {
    std::uint64_t hash = 0;
    std::shared_ptr<const topomap::LocalMap> map;
  };
  struct Ready {
    Job job;
    std::shared_ptr<const topomap::LocalMap> reference;
    std::shared_ptr<const topomap::LocalMap> query;
  };
  struct Waiting {
    Job job;
    Clock::time_point until;
  };
  /// Of one slot: a matcher for each robot, with the maps that the slot was asked for.
  using Matchers = std::map<std::string, localization::Matcher>;

  void work();
  /// Waits for a job; nothing when it is time to stop. `missing` is set when its maps did not come.
  std::optional<Ready> next_job(bool& missing);
  [[nodiscard]] std::shared_ptr<const topomap::LocalMap> held(const std::string& robot_id,
                                                              std::uint32_t id,
                                                              std::uint64_t hash) const;
  [[nodiscard]] std::optional<Ready> make_ready(Job& job) const;
  static Outcome solve(Matchers& matchers, const Ready& ready);

  std::chrono::nanoseconds map_patience_;
  OutcomeHandler on_outcome_;
  mutable std::mutex mutex_;  // guards all below
  std::condition_variable changed_;
  std::map<std::pair<std::string, std::uint32_t>, HeldMap> maps_;  // by robot and id
  std::deque<Ready> ready_;
  std::list<Waiting> waiting_;  // oldest first
  std::size_t in_hand_ = 0;
  std::chrono::nanoseconds busy_{0};
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace topogeo::ga_worker
