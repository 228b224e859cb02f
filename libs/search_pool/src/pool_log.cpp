#include "topogeo/search_pool/pool_log.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::search_pool {

namespace {

constexpr std::chrono::seconds kPeriod{1};
constexpr std::size_t kNamed = 3;  // workers named in one line

std::string count_of(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// "worker a joined", "workers a, b joined", "workers a, b, c and 5 more joined".
std::string sentence(const std::vector<std::string>& ids, const char* verb) {
  std::string text = ids.size() == 1 ? "worker " : "workers ";
  for (std::size_t i = 0; i < std::min(ids.size(), kNamed); ++i) {
    text += (i == 0 ? "" : ", ") + ids[i];
  }
  if (ids.size() > kNamed) text += " and " + std::to_string(ids.size() - kNamed) + " more";
  return text + " " + verb;
}

const char* to_string(WorkerFault fault) {
  switch (fault) {
    case WorkerFault::kStalled:
      return "stalled";
    case WorkerFault::kLost:
      return "lost";
    case WorkerFault::kExcluded:
      break;
  }
  return "excluded";
}

}  // namespace

PoolLog::PoolLog(Sink sink) : sink_(std::move(sink)) {}

void PoolLog::workers(const std::vector<std::string>& ids, BoardTime now) {
  if (last_change_ && now - *last_change_ < kPeriod) return;
  const std::set<std::string> present(ids.begin(), ids.end());
  std::vector<std::string> joined;
  std::vector<std::string> left;
  std::set_difference(present.begin(), present.end(), known_.begin(), known_.end(),
                      std::back_inserter(joined));
  std::set_difference(known_.begin(), known_.end(), present.begin(), present.end(),
                      std::back_inserter(left));
  if (joined.empty() && left.empty()) return;
  std::string line;
  if (!joined.empty()) line += sentence(joined, "joined") + ", ";
  if (!left.empty()) line += sentence(left, "left") + ", ";
  sink_(line + count_of(ids.size(), "worker"));
  known_ = present;
  last_change_ = now;
}

void PoolLog::searching_here(std::size_t workers, BoardTime now) {
  if (std::exchange(searches_here_, true)) return;
  if (last_search_here_ && now - *last_search_here_ < kPeriod) return;
  last_search_here_ = now;
  const char* who = workers > 0    ? "no worker answers"
                    : last_change_ ? "no worker left"
                                   : "no worker";
  sink_(std::string(who) + ", searching in this process");
}

void PoolLog::recovered(const Recovery& recovery) {
  sink_(fmt::format("worker {} {} with {}, answered elsewhere after {:.2f} s", recovery.worker_id,
                    to_string(recovery.fault), count_of(recovery.tasks, "task"),
                    std::chrono::duration<double>(recovery.duration).count()));
}

}  // namespace topogeo::search_pool
