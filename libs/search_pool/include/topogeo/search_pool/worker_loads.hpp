// The workers of a TaskBoard: what each has in hand, and who gets the next task.
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
  std::uint32_t forgotten = 0;  ///< how often it lost what it had in hand since its last answer
  std::vector<InHand> in_hand;  ///< oldest first
};

class WorkerLoads {
 public:
  explicit WorkerLoads(const BoardConfig& options);

  using Workers = std::map<std::string, Worker>;
  [[nodiscard]] Workers& all() { return workers_; }
  [[nodiscard]] const Workers& all() const { return workers_; }
  /// Null when it is not known.
  Worker* find(const std::string& worker_id);

  /// Ids of the workers that take tasks, ascending.
  [[nodiscard]] std::vector<std::string> usable() const;
  [[nodiscard]] std::size_t count_usable() const;

  /// So many tasks have no answer yet: workers get their share of them (BoardConfig).
  void set_open_tasks(std::size_t open);

  /// The worker with room that has the smallest load for its slots, first by id among equals, but
  /// none of those that have `tried`; null for none.
  [[nodiscard]] Workers::value_type* choose(const std::set<std::string>& tried, BoardTime now);
  /// True when some worker, but none of those that have `tried`, takes tasks and answers in time,
  /// as far as is known: it has room for a task sooner or later.
  [[nodiscard]] bool any_in_service(const std::set<std::string>& tried, BoardTime now) const;
  /// Takes a task out of a worker's hands; when it was given to it, or nothing when it was not.
  static std::optional<BoardTime> take(Worker& worker, std::uint64_t task_id);

  /// A task was answered so long after it was sent.
  void note_answer_time(BoardTime time);
  /// A task that is out for longer is taken to be a straggler.
  [[nodiscard]] BoardTime straggler_time() const { return straggler_time_; }
  /// When the next task becomes a straggler; nothing when none is out that is not one already.
  [[nodiscard]] std::optional<BoardTime> next_straggler(BoardTime now) const;
  /// True when the worker's oldest task is so old that no answer will come. Then the others are
  /// stragglers, too.
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
