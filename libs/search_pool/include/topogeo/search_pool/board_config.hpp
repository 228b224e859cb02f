// Settings of a TaskBoard for its workers.
#pragma once

#include <chrono>
#include <cstdint>

namespace topogeo::search_pool {

/// Time on one steady clock, from any start.
using BoardTime = std::chrono::nanoseconds;

struct BoardConfig {
  /// Minimum of tasks per slot of a worker: one to work on, the others so that it is not idle while
  /// an answer travels. A new worker gets no more before its probation is over.
  std::uint32_t tasks_per_slot = 2;
  /// Maximum of tasks per slot: a large batch travels in messages of several tasks. In a small
  /// batch each worker gets half of its share, so that all finish together.
  std::uint32_t most_tasks_per_slot = 64;
  /// Maximum of tasks per worker, whatever its slots; the task history of a worker on the wire
  /// holds 128 messages, in the worst case of one task each.
  std::uint32_t tasks_per_worker = 100;
  /// A task without an answer for this time is also given to another worker ...
  BoardTime straggler_floor = std::chrono::milliseconds(250);
  /// ... or for this multiple of the median time of recent answers, if that is longer.
  double straggler_factor = 20.0;
  /// Pause without tasks for a worker that lacked a map or could not be reached.
  BoardTime rest = std::chrono::seconds(5);
  /// An answer overdue by this time counts as lost, and its worker gets new tasks: longer than a
  /// busy machine stalls, short compared with a drive.
  BoardTime forget_after = std::chrono::seconds(2);
  /// Upper limit of the time, which doubles with each repetition without an answer: tasks of a
  /// hanging worker wait until they are stragglers.
  BoardTime longest_forget_after = std::chrono::seconds(30);
  /// Number of first answers of every worker that are compared with the answer of this process,
  std::uint32_t probation = 3;
  /// and one in this many of the later ones, chosen by the task's id; 0: none.
  std::uint32_t audit_every = 64;
};

}  // namespace topogeo::search_pool
