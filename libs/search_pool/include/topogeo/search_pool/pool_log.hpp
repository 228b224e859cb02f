// Log lines about the search pool for its users: workers that came and went, and answers delayed by
// a loss.
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

/// Has no clock: callers pass the time of one steady clock.
class PoolLog {
 public:
  using Sink = std::function<void(const std::string& line)>;

  explicit PoolLog(Sink sink);

  /// Sets the usable workers. Changes are logged at most once per second, without those reverted in
  /// between.
  void workers(const std::vector<std::string>& ids, BoardTime now);
  /// A task has to be solved in this process although there are `workers` of them. Logged for the
  /// first one since a worker answered, at most once per second.
  void searching_here(std::size_t workers, BoardTime now);
  /// A worker has answered.
  void answered() { searches_here_ = false; }
  void recovered(const Recovery& recovery);

 private:
  Sink sink_;
  std::set<std::string> known_;  // as last logged
  std::optional<BoardTime> last_change_;
  std::optional<BoardTime> last_search_here_;
  bool searches_here_ = false;
};

}  // namespace topogeo::search_pool
