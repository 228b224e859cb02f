// The lines of the log that concern a user of the search pool: which workers came and went, and how
// long a loss delayed answers.
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

/// Has no clock: callers pass the time, of one steady clock.
class PoolLog {
 public:
  using Sink = std::function<void(const std::string& line)>;

  explicit PoolLog(Sink sink);

  /// The workers that can be used now. Logged when others than before, once per second at most;
  /// what came and went again in between is left out.
  void workers(const std::vector<std::string>& ids, BoardTime now);
  /// A task has to be solved in this process, with so many workers there. Logged when it is the
  /// first one since a worker answered, once per second at most.
  void searching_here(std::size_t workers, BoardTime now);
  /// A worker has answered.
  void answered() { searches_here_ = false; }
  void recovered(const Recovery& recovery);

 private:
  Sink sink_;
  std::set<std::string> known_;  // as logged last
  std::optional<BoardTime> last_change_;
  std::optional<BoardTime> last_search_here_;
  bool searches_here_ = false;
};

}  // namespace topogeo::search_pool
