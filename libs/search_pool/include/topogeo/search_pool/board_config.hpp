// How a TaskBoard deals with its workers.
#pragma once

#include <chrono>
#include <cstdint>

namespace topogeo::search_pool {

/// Since any start of one steady clock.
using BoardTime = std::chrono::nanoseconds;

struct BoardConfig {
  /// Tasks given to a worker for each of its slots, at least: one to work on, the rest so that it
  /// does not stand still while an answer travels. A new worker gets no more before its probation
  /// is over.
  std::uint32_t tasks_per_slot = 2;
  /// At most: a large batch travels in messages of several tasks. Of a small one each worker gets a
  /// half of its share, so that all end together.
  std::uint32_t most_tasks_per_slot = 64;
  /// Tasks given to one worker at most, whatever its slots; the task history of a worker on the
  /// wire holds 128 messages, of one task each at worst.
  std::uint32_t tasks_per_worker = 100;
  /// A task without an answer for so long is also given to another worker ...
  BoardTime straggler_floor = std::chrono::milliseconds(250);
  /// ... or for so many times the median time of recent answers, if that is longer.
  double straggler_factor = 20.0;
  /// How long a worker that did not hold a map, or could not be sent to, gets nothing.
  BoardTime rest = std::chrono::seconds(5);
  /// A worker that owes an answer is taken to have lost the task after so long, and gets new ones:
  /// longer than a machine stalls that has other work, short beside a drive.
  BoardTime forget_after = std::chrono::seconds(2);
  /// Twice as long each time that it has answered nothing since, up to this: tasks for a worker
  /// that hangs wait for the time of a straggler.
  BoardTime longest_forget_after = std::chrono::seconds(30);
  /// So many first answers of every worker are compared with the answer of this process,
  std::uint32_t probation = 3;
  /// and one in so many of the later ones, chosen by the task's id; 0: none.
  std::uint32_t audit_every = 64;
};

}  // namespace topogeo::search_pool
