// Which workers there are, by their reports, and which of them are of use.
//
// A worker id belongs to the process that showed it first; another one under the same id is
// ignored until the first has gone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "topogeo/search_pool/process_id.hpp"

namespace topogeo::search_pool {

/// What answers of a worker depend on: it must agree with that of the client.
struct Build {
  std::string version;                    ///< of the software
  std::uint64_t matcher_fingerprint = 0;  ///< of what the matcher makes of a known task
  std::uint64_t config_fingerprint = 0;   ///< of the configuration; a worker's 0: any will do
};

/// What a worker reports of itself.
struct WorkerReport {
  std::string worker_id;
  std::string host;
  Build build;
};

struct RegistryCounts {
  std::uint64_t other_version = 0;        ///< workers refused for it
  std::uint64_t other_matcher = 0;        ///< the same
  std::uint64_t other_configuration = 0;  ///< the same
  std::uint64_t shared_ids = 0;           ///< worker ids that several processes showed
};

class WorkerRegistry {
 public:
  /// A fault with a fixed reason and what happened this time.
  struct Fault {
    std::string reason;
    std::string detail;
  };
  /// What follows from a report.
  struct Verdict {
    bool usable = false;
    std::optional<Fault> fault;  ///< once for each worker
  };

  explicit WorkerRegistry(Build own);

  /// A report came from a process, on an instance of the status topic.
  Verdict update(const WorkerReport& report, const ProcessId& from, const InstanceId& instance);
  /// An instance is gone with its writer in `process`; all zero: it is not known in which. Returns
  /// the worker that is gone with it, if it was one.
  std::optional<std::string> gone(const InstanceId& instance, const ProcessId& process);
  /// Time has passed. The workers that were silent for `silent_ticks` ticks are gone.
  std::vector<std::string> tick(int silent_ticks);

  /// True when messages under this id are to be accepted from this process: the id belongs to it,
  /// or did until it went.
  [[nodiscard]] bool is_owner(const ProcessId& from, const std::string& worker_id) const;
  /// The process that an id belongs to; all zero when there is none.
  [[nodiscard]] ProcessId owner(const std::string& worker_id) const;
  [[nodiscard]] std::vector<std::string> workers_of(const ProcessId& process) const;
  /// "id on host", as far as known.
  [[nodiscard]] std::string name(const std::string& worker_id) const;
  [[nodiscard]] const RegistryCounts& counts() const { return counts_; }

 private:
  struct Entry {
    ProcessId owner{};
    InstanceId instance{};
    std::string host;
    int silent = 0;                   // ticks since its last report
    std::map<ProcessId, int> others;  // under the same id, with their silent ticks
  };
  struct Former {
    std::string worker_id;
    ProcessId owner{};
  };

  void remove(const std::string& worker_id);
  std::optional<Fault> refusal(const WorkerReport& report);
  /// True when no fault was reported for this worker yet.
  bool first_time(const std::string& worker_id);

  Build own_;
  std::map<std::string, Entry> entries_;  // by worker id
  std::deque<Former> former_;             // last ones, for answers that come late
  std::set<std::string> reported_;        // workers with a fault
  RegistryCounts counts_;
};

}  // namespace topogeo::search_pool
