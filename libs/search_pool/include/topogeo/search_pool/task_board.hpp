// Bookkeeping of the search pool: which worker has which match task (docs/architecture.md).
//
// Tasks come in batches; the answers of a batch do not depend on who gave them or when. Workers are
// checked: some of their answers are solved again here (audits), and after a difference all answers
// of the worker in this batch are discarded. The board has no network and no clock: callers pass
// events with their time and ask for the next action.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/search_pool/recovery.hpp"
#include "topogeo/search_pool/reference_holders.hpp"
#include "topogeo/search_pool/task_batch.hpp"
#include "topogeo/search_pool/worker_loads.hpp"

namespace topogeo::search_pool {

struct BoardCounts {
  std::uint64_t sent = 0;                   ///< to workers, including repetitions
  std::uint64_t resent = 0;                 ///< of these, after a first attempt elsewhere
  std::uint64_t in_process = 0;             ///< solved by the client itself
  std::uint64_t duplicates = 0;             ///< answers to tasks already answered
  std::uint64_t duplicate_differences = 0;  ///< of these, different from the first answer: a fault
  std::uint64_t audits = 0;                 ///< answers solved again by the client
  std::uint64_t audit_differences = 0;      ///< of these, different from the client's: a fault
  std::uint64_t redone = 0;                 ///< answered tasks repeated because their worker erred
  std::uint64_t ignored = 0;                ///< answers to no open task
  std::uint64_t map_missing = 0;
  std::uint64_t failed = 0;            ///< refused by a worker with another reason
  std::uint64_t workers_lost = 0;      ///< gone with tasks in hand
  std::uint64_t workers_excluded = 0;  ///< found to be unusable
  BoardTime last_recovery{0};          ///< see Recovery; 0: none yet
  BoardTime longest_recovery{0};
};

/// Reason of a worker for giving no answer.
enum class Refusal : std::uint8_t { kMapMissing, kFailed };

/// Effect of an answer.
enum class Reception : std::uint8_t {
  kFirst,      ///< it counts
  kDuplicate,  ///< the task had the same answer before
  kDifferent,  ///< the task had another answer before: to be settled
  kUnknown,    ///< no task waits for it
};

class TaskBoard {
 public:
  struct Assignment {
    std::size_t task = 0;  ///< index in the batch
    std::string worker_id;
  };
  /// An answer that differs from that of this process.
  struct Difference {
    std::string worker_id;
    localization::MatchResult answer;
    std::uint64_t unchecked = 0;  ///< earlier answers of the worker that stay accepted
  };

  explicit TaskBoard(const BoardConfig& options = {});

  /// A worker is present with this number of slots; 0: it takes no more tasks.
  void worker_up(const std::string& worker_id, std::uint32_t slots, BoardTime now);
  /// A worker is gone: its tasks go to others.
  void worker_gone(const std::string& worker_id);
  /// A worker must not be used any more; its tasks go to others. True if it was in use.
  bool exclude(const std::string& worker_id, BoardTime now);
  /// Excludes a worker that gave a wrong answer, and repeats its answered tasks of this batch,
  /// except compared ones.
  bool distrust(const std::string& worker_id, BoardTime now);
  /// Whether the reader of a worker is connected, so that it can be given tasks. Initially false.
  void set_reachable(const std::string& worker_id, bool reachable);

  /// Starts a batch. The previous one must be done or abandoned. Task ids must be new.
  void begin(std::span<const localization::MatchTask> tasks);
  /// Forgets the batch.
  void abandon();
  [[nodiscard]] bool done() const { return batch_.open() == 0 && audits_.empty(); }
  /// The answers in the order of the tasks; ends the batch. Throws std::logic_error unless done().
  std::vector<localization::MatchResult> take_results();

  /// The next task to send, counted as sent; empty if every worker has enough.
  std::optional<Assignment> next_remote(BoardTime now);
  /// The next task that the client must solve itself, because no worker is left for it. Ask when
  /// next_remote is empty. The answer goes to solved().
  std::optional<std::size_t> next_local(BoardTime now);
  /// The next answered task that the client solves too, for comparison by settle().
  [[nodiscard]] std::optional<std::size_t> next_audit() const;
  /// Time at which the board must be asked again even without events.
  [[nodiscard]] std::optional<BoardTime> next_deadline(BoardTime now) const;

  /// A task of the batch, by index.
  [[nodiscard]] const localization::MatchTask& task(std::size_t index) const;
  /// A task given to the worker, of this batch or an earlier one; null if it was not, or its answer
  /// no longer matters.
  [[nodiscard]] const localization::MatchTask* given(const std::string& worker_id,
                                                     std::uint64_t task_id) const;
  /// True if this task of the batch has no answer yet.
  [[nodiscard]] bool is_open(std::uint64_t task_id) const;

  Reception answer(const std::string& worker_id, localization::MatchResult result, BoardTime now);
  /// Counts an answer that is not accepted for its sender.
  void ignore_answer() { ++counts_.ignored; }
  void refuse(const std::string& worker_id, std::uint64_t task_id, Refusal refusal, BoardTime now);
  void solved(std::size_t task, localization::MatchResult result, BoardTime now);
  /// Sets the answer of this process to an answered task. It replaces different answers, whose
  /// workers are distrusted and returned.
  std::vector<Difference> settle(const localization::MatchResult& truth, BoardTime now);
  /// The task could not be sent.
  void not_sent(const Assignment& assignment, BoardTime now);

  /// Number of tasks of the batch without an answer.
  [[nodiscard]] std::size_t open_tasks() const { return batch_.open(); }
  /// Number of workers that take tasks.
  [[nodiscard]] std::size_t workers() const { return workers_.count_usable(); }
  [[nodiscard]] std::vector<std::string> usable_workers() const { return workers_.usable(); }
  [[nodiscard]] bool is_excluded(const std::string& worker_id) const;
  [[nodiscard]] const BoardCounts& counts() const { return counts_; }
  /// Recoveries completed since the last call.
  std::vector<Recovery> take_recoveries();

 private:
  Assignment assign(std::size_t index, WorkerLoads::Workers::value_type& worker, BoardTime now);
  [[nodiscard]] std::optional<Assignment> place_waiting(BoardTime now);
  /// A task of this batch or an earlier one.
  [[nodiscard]] const BoardTask* find(std::uint64_t task_id) const;
  void accept(std::size_t index, localization::MatchResult result, const std::string& worker_id,
              BoardTime now);
  [[nodiscard]] bool audit_is_due(Worker* worker, std::uint64_t task_id) const;
  void take_from(const std::string& worker_id, Worker& worker, std::uint64_t task_id);
  void take_all_from(const std::string& worker_id, Worker& worker);
  void forget_lost(BoardTime now);
  [[nodiscard]] std::vector<std::uint64_t> open_in_hand(const Worker& worker) const;
  void report_stalled(const BoardTask& task);

  BoardConfig options_;
  WorkerLoads workers_;
  ReferenceHolders holders_;
  RecoveryWatch recovery_;
  TaskBatch batch_;
  std::set<std::size_t> audits_;             // answered, to be compared
  std::map<std::uint64_t, BoardTask> kept_;  // of earlier batches, for late answers
  BoardCounts counts_;
};

}  // namespace topogeo::search_pool
