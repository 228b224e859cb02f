// How long the search pool takes to get over a worker that leaves it in the lurch.
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
  /// Something happened to a worker with open tasks, which showed its last sign of life at `since`.
  /// Told again of the same worker, the tasks come to those before and the earliest time counts.
  void begin(const std::string& worker_id, WorkerFault fault, BoardTime since,
             const std::vector<std::uint64_t>& task_ids);
  /// A task has its answer, from a worker or (empty) from this process.
  void answered(std::uint64_t task_id, const std::string& worker_id, BoardTime now);
  /// Nobody waits for the tasks any more.
  void abandon() { cases_.clear(); }

  /// What was got over since the last call, in the order in which it was. A worker that answered
  /// all of its tasks itself after all is left out.
  std::vector<Recovery> take();

 private:
  struct Case {
    WorkerFault fault{};
    BoardTime since{0};
    std::size_t tasks = 0;
    std::set<std::uint64_t> left;  // task ids
    bool elsewhere = false;        // an answer came from somebody else
  };
  std::map<std::string, Case> cases_;  // by worker id
  std::vector<Recovery> done_;
};

}  // namespace topogeo::search_pool
