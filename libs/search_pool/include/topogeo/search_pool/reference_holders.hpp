// Tracks which workers recently searched in which reference maps and still have the look-up grids,
// whose construction takes a twentieth of a search. It only affects speed, not answers.
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
  /// A task with this reference map goes to the worker.
  void add(const std::string& worker_id, std::uint64_t reference_hash);
  /// The worker is gone, or gets no more tasks.
  void forget(const std::string& worker_id);

  /// Chooses the next task of the worker among `waiting`, indices in `batch`: the first whose
  /// reference it holds; otherwise the first whose reference no worker holds; otherwise the first
  /// of all. Considers only the next 64. `waiting` must not be empty.
  [[nodiscard]] std::size_t choose(const std::string& worker_id,
                                   const std::set<std::size_t>& waiting,
                                   const TaskBatch& batch) const;

 private:
  void release(std::uint64_t reference_hash);

  std::map<std::string, std::deque<std::uint64_t>> held_;      // by worker, latest last
  std::unordered_map<std::uint64_t, std::size_t> holders_of_;  // number of workers that hold it
};

}  // namespace topogeo::search_pool
