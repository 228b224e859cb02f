#include "topogeo/search_pool/recovery.hpp"

#include <algorithm>
#include <utility>

namespace topogeo::search_pool {

void RecoveryWatch::begin(const std::string& worker_id, WorkerFault fault, BoardTime since,
                          const std::vector<std::uint64_t>& task_ids) {
  const auto found = cases_.find(worker_id);
  if (found == cases_.end() && task_ids.empty()) return;
  Case& entry = found == cases_.end() ? cases_[worker_id] : found->second;
  entry.since = found == cases_.end() ? since : std::min(entry.since, since);
  entry.fault = fault;
  for (const std::uint64_t task_id : task_ids) {
    if (entry.left.insert(task_id).second) ++entry.tasks;
  }
}

void RecoveryWatch::answered(std::uint64_t task_id, const std::string& worker_id, BoardTime now) {
  for (auto it = cases_.begin(); it != cases_.end();) {
    Case& entry = it->second;
    if (entry.left.erase(task_id) == 0) {
      ++it;
      continue;
    }
    if (worker_id != it->first) entry.elsewhere = true;
    if (!entry.left.empty()) {
      ++it;
      continue;
    }
    if (entry.elsewhere) {
      done_.push_back({it->first, entry.fault, entry.tasks, now - entry.since});
    }
    it = cases_.erase(it);
  }
}

std::vector<Recovery> RecoveryWatch::take() {
  return std::exchange(done_, {});
}

}  // namespace topogeo::search_pool
