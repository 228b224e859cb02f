// Time until other workers have answered the tasks of a failed worker.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "topogeo/search_pool/board_config.hpp"

namespace topogeo::search_pool {

/// Kind of failure of a worker.
enum class WorkerFault : std::uint8_t {
  kStalled,   ///< present without answering
  kLost,      ///< gone
  kExcluded,  ///< gave a wrong answer
};

/// A failed worker's tasks, all answered by other workers or this process.
struct Recovery {
  std::string worker_id;
  WorkerFault fault{};
  std::size_t tasks = 0;
  BoardTime duration{0};  ///< from its last sign of life to the last answer
};

class RecoveryWatch {
 public:
  /// A worker with open tasks failed; its last sign of life was at `since`. Repeated calls for a
  /// worker add their tasks, and the earliest time counts.
  void begin(const std::string& worker_id, WorkerFault fault, BoardTime since,
             const std::vector<std::uint64_t>& task_ids);
  /// A task was answered, by a worker or (empty) by this process.
  void answered(std::uint64_t task_id, const std::string& worker_id, BoardTime now);
  /// The tasks need no answer any more.
  void abandon() { cases_.clear(); }

  /// Recoveries since the last call, in order, without workers that finally answered all their
  /// tasks themselves.
  std::vector<Recovery> take();

 private:
  struct Case {
    WorkerFault fault{};
    BoardTime since{0};
    std::size_t tasks = 0;
    std::set<std::uint64_t> left;  // task ids
    bool elsewhere = false;        // another one gave an answer
  };
  std::map<std::string, Case> cases_;  // by worker id
  std::vector<Recovery> done_;
};

}  // namespace topogeo::search_pool
