// What a user should read of the search pool in the log: who came and went, and how long it took to
// get over a worker.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "topogeo/search_pool/recovery.hpp"

namespace topogeo::search_pool {

/// Knows no clock: the time, of one steady clock, is told to it.
class PoolLog {
 public:
  using Tell = std::function<void(const std::string& line)>;

  explicit PoolLog(Tell tell);

  /// The workers that can be used now. Told when others than before, once per second at most; what
  /// came and went again in between is left out.
  void workers(const std::vector<std::string>& ids, BoardTime now);
  /// A task has to be solved in this process, with so many workers there. Told when it is the first
  /// one since a worker answered, once per second at most.
  void searching_here(std::size_t workers, BoardTime now);
  /// A worker has answered.
  void answered() { searches_here_ = false; }
  void recovered(const Recovery& recovery);

 private:
  Tell tell_;
  std::set<std::string> known_;  // as told last
  std::optional<BoardTime> last_change_;
  std::optional<BoardTime> last_search_here_;
  bool searches_here_ = false;
};

}  // namespace topogeo::search_pool
