// The match tasks of one batch and their states: waiting, out or answered.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/search_pool/recovery.hpp"

namespace topogeo::search_pool {

/// A task and its state.
struct BoardTask {
  localization::MatchTask task;
  bool here_only = false;  ///< only this process may solve it
  bool proven = false;     ///< the answer is this process's own
  std::uint32_t sends = 0;
  BoardTime last_sent{0};
  std::set<std::string> workers;                    ///< workers that have it now
  std::set<std::string> tried;                      ///< workers that had it and were not lost
  std::set<std::string> given;                      ///< workers that ever had it
  std::optional<localization::MatchResult> result;  ///< empty while it is open
  std::string answered_by;                          ///< empty: this process
  std::vector<std::pair<std::string, localization::MatchResult>> others;  ///< different answers
};

class TaskBatch {
 public:
  /// Throws std::logic_error if a task id occurs twice; the batch is then empty.
  void begin(std::span<const localization::MatchTask> tasks);
  void clear();

  [[nodiscard]] std::size_t size() const { return tasks_.size(); }
  /// Tasks without answer.
  [[nodiscard]] std::size_t open() const { return open_; }
  /// Throws std::out_of_range.
  [[nodiscard]] const BoardTask& at(std::size_t index) const { return tasks_.at(index); }
  [[nodiscard]] std::optional<std::size_t> index_of(std::uint64_t task_id) const;

  /// All changes of a task go through here, so that the lists below stay consistent.
  template <class Change>
  void change(std::size_t index, const Change& change) {
    take_off_lists(index);
    change(tasks_[index]);
    put_on_list(index);
  }

  // Each open task is in one of these lists.
  /// Without a worker; any worker will do.
  [[nodiscard]] const std::set<std::size_t>& fresh() const { return fresh_; }
  /// Without a worker; some workers will not do.
  [[nodiscard]] const std::set<std::size_t>& again() const { return again_; }
  /// With a worker, by the time of the last sending.
  [[nodiscard]] const std::set<std::pair<BoardTime, std::size_t>>& out() const { return out_; }

 private:
  void take_off_lists(std::size_t index);
  void put_on_list(std::size_t index);

  std::vector<BoardTask> tasks_;
  std::map<std::uint64_t, std::size_t> index_;  // task id -> index in tasks_
  std::set<std::size_t> fresh_;
  std::set<std::size_t> again_;
  std::set<std::pair<BoardTime, std::size_t>> out_;
  std::size_t open_ = 0;
};

}  // namespace topogeo::search_pool
