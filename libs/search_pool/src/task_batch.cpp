#include "topogeo/search_pool/task_batch.hpp"

#include <stdexcept>

namespace topogeo::search_pool {

void TaskBatch::begin(std::span<const localization::MatchTask> tasks) {
  clear();
  tasks_.resize(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!index_.emplace(tasks[i].task_id, i).second) {
      clear();
      throw std::logic_error("task board: task " + std::to_string(tasks[i].task_id) +
                             " occurs twice in a batch");
    }
    tasks_[i].task = tasks[i];
    put_on_list(i);
  }
}

void TaskBatch::clear() {
  tasks_.clear();
  index_.clear();
  fresh_.clear();
  again_.clear();
  out_.clear();
  open_ = 0;
}

std::optional<std::size_t> TaskBatch::index_of(std::uint64_t task_id) const {
  const auto found = index_.find(task_id);
  if (found == index_.end()) return {};
  return found->second;
}

void TaskBatch::take_off_lists(std::size_t index) {
  const BoardTask& task = tasks_.at(index);
  if (task.result) return;
  --open_;
  if (!task.workers.empty()) {
    out_.erase({task.last_sent, index});
  } else if (task.here_only || !task.tried.empty()) {
    again_.erase(index);
  } else {
    fresh_.erase(index);
  }
}

void TaskBatch::put_on_list(std::size_t index) {
  const BoardTask& task = tasks_[index];
  if (task.result) return;
  ++open_;
  if (!task.workers.empty()) {
    out_.emplace(task.last_sent, index);
  } else if (task.here_only || !task.tried.empty()) {
    again_.insert(index);
  } else {
    fresh_.insert(index);
  }
}

}  // namespace topogeo::search_pool
