// Who works on which match task: the bookkeeping of the search pool (design, the search pool).
//
// Tasks come in batches; answers of a batch do not depend on who gave them or when. The board knows
// no DDS and no clock: what happens and when is told to it, and it says what to do next. Times are
// of one steady clock with any start.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "topogeo/localization/match.hpp"

namespace topogeo::localizer {

using BoardTime = std::chrono::nanoseconds;

struct BoardOptions {
  /// Tasks given to a worker for each of its slots, at most: one to work on, the rest so that it
  /// does not stand still while an answer travels.
  std::uint32_t tasks_per_slot = 2;
  /// Tasks given to one worker at most; the task history of a worker on the wire holds 128.
  std::uint32_t tasks_per_worker = 100;
  /// A task without an answer for so long is also given to somebody else ...
  BoardTime straggler_floor = std::chrono::seconds(1);
  /// ... or for so many times the median time of recent answers, if that is longer.
  double straggler_factor = 20.0;
  /// How long a worker that did not hold a map, or could not be sent to, gets nothing.
  BoardTime rest = std::chrono::seconds(5);
  /// A worker that lost a task gets new ones after so long.
  BoardTime forget_after = std::chrono::seconds(30);
};

struct BoardCounts {
  std::uint64_t sent = 0;                   ///< to workers, repetitions included
  std::uint64_t resent = 0;                 ///< of these, after a first attempt elsewhere
  std::uint64_t in_process = 0;             ///< solved by the client itself
  std::uint64_t duplicates = 0;             ///< answers to tasks that were answered before
  std::uint64_t duplicate_differences = 0;  ///< of these, other than the first answer: a fault
  std::uint64_t map_missing = 0;
  std::uint64_t failed = 0;        ///< refused by a worker with a reason of its own
  std::uint64_t workers_lost = 0;  ///< gone with tasks in hand
};

/// Why a worker gives no answer.
enum class Refusal : std::uint8_t { kMapMissing, kOtherVersion, kFailed };

/// What became of an answer.
enum class Reception : std::uint8_t {
  kFirst,      ///< it counts
  kDuplicate,  ///< the task had the same answer before
  kDifferent,  ///< the task had another answer before
  kUnknown,    ///< nobody waits for it
};

class TaskBoard {
 public:
  struct Assignment {
    std::size_t task = 0;  ///< index in the batch
    std::string worker_id;
  };

  explicit TaskBoard(const BoardOptions& options = {});

  /// A worker says that it is there, with so many slots; 0: it takes no more tasks. `incarnation`
  /// differs between two runs of one worker id; a new one has lost the tasks of the one before.
  void worker_up(const std::string& worker_id, std::uint32_t slots, std::uint64_t incarnation);
  /// A worker is not there any more: its tasks go to others.
  void worker_gone(const std::string& worker_id);
  /// A worker must not be used until it comes back in a new incarnation. True if that is news.
  bool exclude(const std::string& worker_id);
  /// A worker can be given tasks, or not yet: its reader is not connected. Workers start without.
  void set_reachable(const std::string& worker_id, bool reachable);

  /// Starts a batch. The last one must be done or abandoned. Task ids must be new.
  void begin(std::span<const localization::MatchTask> tasks);
  /// Forgets the batch.
  void abandon();
  [[nodiscard]] bool done() const { return open_ == 0; }
  /// The answers in the order of the tasks; ends the batch. Throws std::logic_error unless done().
  std::vector<localization::MatchResult> take_results();

  /// The next task to send, counted as sent; nothing when every worker has enough.
  std::optional<Assignment> next_remote(BoardTime now);
  /// The next task that the client has to solve itself, because no worker is left for it. Ask after
  /// next_remote has nothing. Its answer goes to solved().
  std::optional<std::size_t> next_local(BoardTime now);
  /// When the board should be asked again although nothing happened.
  [[nodiscard]] std::optional<BoardTime> next_deadline(BoardTime now) const;

  Reception answer(const std::string& worker_id, const localization::MatchResult& result,
                   BoardTime now);
  void refuse(const std::string& worker_id, std::uint64_t task_id, Refusal refusal, BoardTime now);
  Reception solved(std::size_t task, const localization::MatchResult& result);
  /// The task could not be sent after all.
  void not_sent(const Assignment& assignment, BoardTime now);

  /// Workers that take tasks.
  [[nodiscard]] std::size_t workers() const;
  [[nodiscard]] const BoardCounts& counts() const { return counts_; }

 private:
  struct Worker {
    std::uint32_t slots = 0;
    std::uint64_t incarnation = 0;
    bool present = false;
    bool reachable = false;
    bool excluded = false;
    BoardTime rests_until{0};
    std::map<std::uint64_t, BoardTime> in_hand;  // task id -> when it was sent
  };
  using Workers = std::map<std::string, Worker>;
  struct Task {
    std::uint64_t id = 0;
    bool here_only = false;
    bool solved_here = false;
    std::uint32_t sends = 0;
    BoardTime last_sent{0};
    std::set<std::string> workers;                    // that have it now
    std::set<std::string> tried;                      // that had it and were not lost
    std::optional<localization::MatchResult> result;  // none while it is open
  };

  /// Takes tasks and answers in time, as far as one knows.
  [[nodiscard]] bool in_service(const Worker& worker, BoardTime now) const;
  [[nodiscard]] bool has_room(const Worker& worker) const;
  [[nodiscard]] bool straggles(const Task& task, BoardTime now) const;
  /// The worker with the smallest load for its slots, first by id among equals; end() for none.
  Workers::iterator choose(const Task& task, BoardTime now);
  Assignment assign(std::size_t task, Workers::iterator worker, BoardTime now);
  /// True when a worker will have room for the task sooner or later.
  [[nodiscard]] bool worth_waiting(const Task& task, BoardTime now) const;
  Task* find(std::uint64_t task_id);
  void take_from(const std::string& worker_id, Worker& worker, std::uint64_t task_id);
  void lose(const std::string& worker_id, Worker& worker);
  void take_all_from(const std::string& worker_id, Worker& worker);
  /// An answer came: first or not.
  Reception receive(std::uint64_t task_id, const localization::MatchResult& result);
  void keep_for_comparison(const Task& task);
  void note_answer_time(BoardTime time);
  void forget_lost(BoardTime now);

  BoardOptions options_;
  Workers workers_;
  std::vector<Task> tasks_;
  std::map<std::uint64_t, std::size_t> index_;  // task id -> index in tasks_
  std::set<std::size_t> waiting_;               // open and with nobody
  std::set<std::size_t> out_;                   // open and with a worker
  std::size_t open_ = 0;
  std::map<std::uint64_t, localization::MatchResult> resent_answers_;  // by task id
  std::deque<BoardTime> answer_times_;                                 // of recent answers
  BoardTime straggler_time_;
  BoardCounts counts_;
};

/// True when every field has the same bits.
bool identical(const localization::MatchResult& a, const localization::MatchResult& b);

}  // namespace topogeo::localizer
