// Known workers, by their reports, and whether they are usable.
//
// A worker id belongs to the process that used it first; another process with the same id is
// ignored until the first is gone.
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

/// Properties that the answers of a worker depend on; they must agree with the client's.
struct Build {
  std::string version;                    ///< of the software
  std::uint64_t matcher_fingerprint = 0;  ///< of the matcher's answer to a known task
  std::uint64_t config_fingerprint = 0;   ///< of the configuration; 0 from a worker: any
};

/// Report of a worker about itself.
struct WorkerReport {
  std::string worker_id;
  std::string host;
  Build build;
};

struct RegistryCounts {
  std::uint64_t other_version = 0;        ///< workers refused for this reason
  std::uint64_t other_matcher = 0;        ///< the same
  std::uint64_t other_configuration = 0;  ///< the same
  std::uint64_t shared_ids = 0;           ///< worker ids used by several processes
};

class WorkerRegistry {
 public:
  /// A fault with a fixed reason and details of this case.
  struct Fault {
    std::string reason;
    std::string detail;
  };
  /// Result of a report.
  struct Verdict {
    bool usable = false;
    std::optional<Fault> fault;  ///< once per worker
  };

  explicit WorkerRegistry(Build own);

  /// Handles a report from a process, on an instance of the status topic.
  Verdict update(const WorkerReport& report, const ProcessId& from, const InstanceId& instance);
  /// An instance is gone with its writer in `process`; all zero: the process is unknown. Returns
  /// the worker that is gone with it, if any.
  std::optional<std::string> gone(const InstanceId& instance, const ProcessId& process);
  /// Advances time by one tick. Returns the workers that are gone because they were silent for more
  /// than `silent_ticks` ticks.
  std::vector<std::string> tick(int silent_ticks);

  /// True if messages under this id are accepted from this process: the id belongs to it, or did
  /// until it was gone.
  [[nodiscard]] bool is_owner(const ProcessId& from, const std::string& worker_id) const;
  /// The process that an id belongs to; all zero if there is none.
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
  /// True if no fault of this worker has been reported yet.
  bool first_time(const std::string& worker_id);

  Build own_;
  std::map<std::string, Entry> entries_;  // by worker id
  std::deque<Former> former_;             // latest ones, for late answers
  std::set<std::string> reported_;        // workers with a fault
  RegistryCounts counts_;
};

}  // namespace topogeo::search_pool
