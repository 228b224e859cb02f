// How long it takes until the tasks of a worker that failed are answered by others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "topogeo/search_pool/board_config.hpp"

namespace topogeo::search_pool {

/// How a worker failed.
enum class WorkerFault : std::uint8_t {
  kStalled,   ///< it is there and does not answer
  kLost,      ///< it is gone
  kExcluded,  ///< it gave a wrong answer
};

/// A worker's tasks, all answered by others or by this process.
struct Recovery {
  std::string worker_id;
  WorkerFault fault{};
  std::size_t tasks = 0;
  BoardTime duration{0};  ///< from its last sign of life to the last answer
};

class RecoveryWatch {
 public:
  /// A worker with open tasks failed, which showed its last sign of life at `since`.
  /// Called again for the same worker, its tasks are added and the earliest time counts.
  void begin(const std::string& worker_id, WorkerFault fault, BoardTime since,
             const std::vector<std::uint64_t>& task_ids);
  /// A task has its answer, from a worker or (empty) from this process.
  void answered(std::uint64_t task_id, const std::string& worker_id, BoardTime now);
  /// The tasks need no answer any more.
  void abandon() { cases_.clear(); }

  /// Recoveries since the last call, in their order. A worker that answered
  /// all of its tasks itself after all is left out.
  std::vector<Recovery> take();

 private:
  struct Case {
    WorkerFault fault{};
    BoardTime since{0};
    std::size_t tasks = 0;
    std::set<std::uint64_t> left;  // task ids
    bool elsewhere = false;        // an answer did not come from it
  };
  std::map<std::string, Case> cases_;  // by worker id
  std::vector<Recovery> done_;
};

}  // namespace topogeo::search_pool
