// The workers of a TaskBoard: their tasks in hand, and the choice for the next task.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "topogeo/search_pool/board_config.hpp"

namespace topogeo::search_pool {

/// State of a worker on the board.
struct Worker {
  struct InHand {
    std::uint64_t task_id = 0;
    BoardTime sent{0};
  };
  std::uint32_t slots = 0;
  bool present = false;
  bool reachable = false;
  bool excluded = false;
  BoardTime rests_until{0};
  BoardTime last_life{0};
  std::uint64_t answers = 0;    ///< first answers to their tasks
  std::uint64_t unchecked = 0;  ///< of these, in finished batches and never compared
  std::uint32_t forgotten = 0;  ///< number of losses of all its tasks since its last answer
  std::vector<InHand> in_hand;  ///< oldest first
};

class WorkerLoads {
 public:
  explicit WorkerLoads(const BoardConfig& options);

  using Workers = std::map<std::string, Worker>;
  [[nodiscard]] Workers& all() { return workers_; }
  [[nodiscard]] const Workers& all() const { return workers_; }
  /// Null for an unknown worker.
  Worker* find(const std::string& worker_id);

  /// Ids of the workers that take tasks, ascending.
  [[nodiscard]] std::vector<std::string> usable() const;
  [[nodiscard]] std::size_t count_usable() const;

  /// Sets the number of tasks without an answer, of which workers get their share (BoardConfig).
  void set_open_tasks(std::size_t open);

  /// The worker with room and the smallest load per slot, lowest id among equals, except those in
  /// `tried`; null for none.
  [[nodiscard]] Workers::value_type* choose(const std::set<std::string>& tried, BoardTime now);
  /// True if some worker, except those in `tried`, takes tasks and answers in time, as far as
  /// known: sooner or later it has room for a task.
  [[nodiscard]] bool any_in_service(const std::set<std::string>& tried, BoardTime now) const;
  /// Removes a task from a worker; returns when it was sent, or empty if the worker did not have
  /// it.
  static std::optional<BoardTime> take(Worker& worker, std::uint64_t task_id);

  /// Records the time between a task and its answer.
  void note_answer_time(BoardTime time);
  /// A task that is out for longer counts as a straggler.
  [[nodiscard]] BoardTime straggler_time() const { return straggler_time_; }
  /// Time at which the next task becomes a straggler; empty if all tasks that are out already are.
  [[nodiscard]] std::optional<BoardTime> next_straggler(BoardTime now) const;
  /// True if the worker's oldest task is so old that no answer will come. Its other tasks then
  /// count as stragglers, too.
  [[nodiscard]] bool has_forgotten(const Worker& worker, BoardTime now) const;

 private:
  [[nodiscard]] bool in_service(const Worker& worker, BoardTime now) const;
  [[nodiscard]] bool has_room(const Worker& worker) const;

  BoardConfig options_;
  Workers workers_;
  std::size_t share_per_slot_ = 0;      // of the open tasks
  std::deque<BoardTime> answer_times_;  // of recent answers
  std::uint64_t answers_noted_ = 0;
  BoardTime straggler_time_;
};

}  // namespace topogeo::search_pool
