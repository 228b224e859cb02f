// Which workers have searched in which reference maps of late, and so still have what the search
// made of them: look-up grids, as long to build as a twentieth of a search takes. A matter of speed
// alone; no answer depends on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

#include "topogeo/search_pool/task_batch.hpp"

namespace topogeo::search_pool {

class ReferenceHolders {
 public:
  /// A task that searches in the map of this content goes to the worker.
  void add(const std::string& worker_id, std::uint64_t reference_hash);
  /// The worker has gone, or gets no tasks any more.
  void forget(const std::string& worker_id);

  /// Of the tasks `waiting`, indices in `batch`, the one that the worker is to get: the first whose
  /// reference it holds; if there is none, the first whose reference nobody holds; if there is none
  /// either, the first of all. Looks at the next 64 alone. `waiting` must not be empty.
  [[nodiscard]] std::size_t choose(const std::string& worker_id,
                                   const std::set<std::size_t>& waiting,
                                   const TaskBatch& batch) const;

 private:
  void release(std::uint64_t reference_hash);

  std::map<std::string, std::deque<std::uint64_t>> held_;      // by worker, the latest last
  std::unordered_map<std::uint64_t, std::size_t> holders_of_;  // how many hold it
};

}  // namespace topogeo::search_pool
