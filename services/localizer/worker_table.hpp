// The workers of a TaskBoard: what each has in hand, and who gets the next task.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "recovery.hpp"

namespace topogeo::localizer {

struct BoardOptions {
  /// Tasks given to a worker for each of its slots, at most: one to work on, the rest so that it
  /// does not stand still while an answer travels. Few, so that one client does not fill the queue
  /// of a worker that others use, too.
  std::uint32_t tasks_per_slot = 2;
  /// Tasks given to one worker at most; the task history of a worker on the wire holds 128.
  std::uint32_t tasks_per_worker = 100;
  /// A task without an answer for so long is also given to somebody else ...
  BoardTime straggler_floor = std::chrono::milliseconds(250);
  /// ... or for so many times the median time of recent answers, if that is longer.
  double straggler_factor = 20.0;
  /// How long a worker that did not hold a map, or could not be sent to, gets nothing.
  BoardTime rest = std::chrono::seconds(5);
  /// A worker that lost a task gets new ones after so long.
  BoardTime forget_after = std::chrono::seconds(30);
  /// So many first answers of every worker are compared with what this process makes of the task,
  std::uint32_t probation = 3;
  /// and one in so many of the later ones, chosen by the task's id; 0: none.
  std::uint32_t audit_every = 64;
};

/// A worker as the board sees it.
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
  std::uint64_t answers = 0;    ///< that were the first ones to their tasks
  std::uint64_t unchecked = 0;  ///< of these, in batches that are over, never compared
  std::vector<InHand> in_hand;  ///< oldest first
};

class WorkerTable {
 public:
  explicit WorkerTable(const BoardOptions& options);

  using Workers = std::map<std::string, Worker>;
  [[nodiscard]] Workers& all() { return workers_; }
  [[nodiscard]] const Workers& all() const { return workers_; }
  /// Null when it is not known.
  Worker* find(const std::string& worker_id);

  /// Ids of the workers that take tasks, ascending.
  [[nodiscard]] std::vector<std::string> usable() const;
  [[nodiscard]] std::size_t count_usable() const;

  /// The worker with room that has the smallest load for its slots, first by id among equals, but
  /// none of those that have `tried`; null for none.
  [[nodiscard]] Workers::value_type* choose(const std::set<std::string>& tried, BoardTime now);
  /// True when some worker, but none of those that have `tried`, takes tasks and answers in time,
  /// as far as one knows: it has room for a task sooner or later.
  [[nodiscard]] bool any_in_service(const std::set<std::string>& tried, BoardTime now) const;
  /// Takes a task out of a worker's hands; when it was given to it, or nothing when it was not.
  static std::optional<BoardTime> take(Worker& worker, std::uint64_t task_id);

  /// A task was answered so long after it was sent.
  void note_answer_time(BoardTime time);
  /// A task that is out for longer is taken to be a straggler.
  [[nodiscard]] BoardTime straggler_time() const { return straggler_time_; }
  /// When the next task becomes a straggler; nothing when none is out that is not one already.
  [[nodiscard]] std::optional<BoardTime> next_straggler(BoardTime now) const;
  /// True when the worker's oldest task is so old that no answer will come.
  [[nodiscard]] bool has_forgotten(const Worker& worker, BoardTime now) const;

 private:
  [[nodiscard]] bool in_service(const Worker& worker, BoardTime now) const;
  [[nodiscard]] bool has_room(const Worker& worker) const;

  BoardOptions options_;
  Workers workers_;
  std::deque<BoardTime> answer_times_;  // of recent answers
  std::uint64_t answers_noted_ = 0;
  BoardTime straggler_time_;
};

}  // namespace topogeo::localizer
