#include "topogeo/search_pool/task_board.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/matching/match.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::search_pool {

using localization::MatchResult;
using localization::MatchTask;

namespace {

/// Tasks kept for comparison with late answers: more than workers hold while one answer travels.
constexpr std::size_t kKeptTasks = 1024;

}  // namespace

TaskBoard::TaskBoard(const BoardConfig& options) : options_(options), workers_(options) {}

// --- workers

void TaskBoard::worker_up(const std::string& worker_id, std::uint32_t slots, BoardTime now) {
  Worker& worker = workers_.all()[worker_id];
  worker.present = true;
  worker.slots = slots;
  worker.last_life = now;
}

void TaskBoard::worker_gone(const std::string& worker_id) {
  Worker* worker = workers_.find(worker_id);
  if (worker == nullptr) return;
  if (!worker->in_hand.empty()) ++counts_.workers_lost;
  recovery_.begin(worker_id, WorkerFault::kLost, worker->last_life, open_in_hand(*worker));
  take_all_from(worker_id, *worker);
  if (!worker->excluded) {
    workers_.all().erase(worker_id);
    return;
  }
  worker->present = false;
  worker->reachable = false;
}

bool TaskBoard::exclude(const std::string& worker_id, BoardTime now) {
  Worker& worker = workers_.all()[worker_id];
  if (worker.excluded) return false;
  worker.excluded = true;
  ++counts_.workers_excluded;
  recovery_.begin(worker_id, WorkerFault::kExcluded, now, open_in_hand(worker));
  take_all_from(worker_id, worker);
  return true;
}

bool TaskBoard::distrust(const std::string& worker_id, BoardTime now) {
  if (!exclude(worker_id, now)) return false;
  std::vector<std::uint64_t> redone;
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    const BoardTask& task = batch_.at(i);
    if (!task.result || task.proven || task.answered_by != worker_id) continue;
    batch_.change(i, [](BoardTask& t) {
      t.result.reset();
      t.answered_by.clear();
      t.others.clear();
    });
    audits_.erase(i);
    redone.push_back(task.task.task_id);
  }
  counts_.redone += redone.size();
  recovery_.begin(worker_id, WorkerFault::kExcluded, now, redone);
  return true;
}

bool TaskBoard::is_excluded(const std::string& worker_id) const {
  const auto found = workers_.all().find(worker_id);
  return found != workers_.all().end() && found->second.excluded;
}

void TaskBoard::set_reachable(const std::string& worker_id, bool reachable) {
  if (Worker* worker = workers_.find(worker_id)) worker->reachable = reachable;
}

// --- batches

void TaskBoard::begin(std::span<const MatchTask> tasks) {
  if (!done()) throw std::logic_error("task board: the last batch is not done");
  abandon();
  batch_.begin(tasks);
}

void TaskBoard::abandon() {
  batch_.clear();
  audits_.clear();
  recovery_.abandon();
}

std::vector<MatchResult> TaskBoard::take_results() {
  if (!done()) throw std::logic_error("task board: the batch is not done");
  std::vector<MatchResult> results;
  results.reserve(batch_.size());
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    const BoardTask& task = batch_.at(i);
    results.push_back(*task.result);
    Worker* worker = task.proven ? nullptr : workers_.find(task.answered_by);
    if (worker != nullptr) ++worker->unchecked;
    // Another worker that got the task may answer too.
    if (task.sends <= (task.answered_by.empty() ? 0U : 1U)) continue;
    kept_.insert_or_assign(task.task.task_id, task);
    if (kept_.size() > kKeptTasks) kept_.erase(kept_.begin());
  }
  abandon();
  return results;
}

const MatchTask& TaskBoard::task(std::size_t index) const {
  return batch_.at(index).task;
}

const BoardTask* TaskBoard::find(std::uint64_t task_id) const {
  if (const auto index = batch_.index_of(task_id)) return &batch_.at(*index);
  const auto kept = kept_.find(task_id);
  return kept == kept_.end() ? nullptr : &kept->second;
}

const MatchTask* TaskBoard::given(const std::string& worker_id, std::uint64_t task_id) const {
  const BoardTask* task = find(task_id);
  return task != nullptr && task->given.contains(worker_id) ? &task->task : nullptr;
}

bool TaskBoard::is_open(std::uint64_t task_id) const {
  const auto index = batch_.index_of(task_id);
  return index && !batch_.at(*index).result;
}

// --- next action

TaskBoard::Assignment TaskBoard::assign(std::size_t index, WorkerLoads::Workers::value_type& worker,
                                        BoardTime now) {
  worker.second.in_hand.push_back({batch_.at(index).task.task_id, now});
  holders_.add(worker.first, batch_.at(index).task.reference_hash);
  ++counts_.sent;
  if (batch_.at(index).sends > 0) ++counts_.resent;
  batch_.change(index, [&](BoardTask& task) {
    task.workers.insert(worker.first);
    task.tried.insert(worker.first);
    task.given.insert(worker.first);
    task.last_sent = now;
    ++task.sends;
  });
  return {index, worker.first};
}

std::optional<TaskBoard::Assignment> TaskBoard::next_remote(BoardTime now) {
  forget_lost(now);
  workers_.set_open_tasks(batch_.open());
  if (auto waiting = place_waiting(now)) return waiting;
  for (const auto& [sent, index] : batch_.out()) {
    if (now - sent < workers_.straggler_time()) break;  // the others are newer
    const BoardTask& task = batch_.at(index);
    if (auto* worker = workers_.choose(task.tried, now)) {
      report_stalled(task);
      return assign(index, *worker, now);
    }
  }
  return {};
}

std::optional<TaskBoard::Assignment> TaskBoard::place_waiting(BoardTime now) {
  for (const std::size_t index : batch_.again()) {
    const BoardTask& task = batch_.at(index);
    if (task.here_only) continue;
    if (auto* worker = workers_.choose(task.tried, now)) return assign(index, *worker, now);
  }
  if (batch_.fresh().empty()) return {};
  auto* worker = workers_.choose({}, now);
  if (worker == nullptr) return {};
  return assign(holders_.choose(worker->first, batch_.fresh(), batch_), *worker, now);
}

std::optional<std::size_t> TaskBoard::next_local(BoardTime now) {
  if (!batch_.fresh().empty() && !workers_.any_in_service({}, now)) return *batch_.fresh().begin();
  for (const std::size_t index : batch_.again()) {
    const BoardTask& task = batch_.at(index);
    if (task.here_only || !workers_.any_in_service(task.tried, now)) return index;
  }
  if (batch_.out().empty()) return {};
  const auto& [sent, oldest] = *batch_.out().begin();
  if (now - sent < workers_.straggler_time()) return {};
  report_stalled(batch_.at(oldest));
  return oldest;
}

std::optional<std::size_t> TaskBoard::next_audit() const {
  if (audits_.empty()) return {};
  return *audits_.begin();
}

std::optional<BoardTime> TaskBoard::next_deadline(BoardTime now) const {
  return workers_.next_straggler(now);
}

// --- answers

Reception TaskBoard::answer(const std::string& worker_id, MatchResult result, BoardTime now) {
  const std::uint64_t task_id = result.task_id;
  Worker* worker = workers_.find(worker_id);
  if (worker != nullptr) {
    worker->last_life = now;
    worker->forgotten = 0;
    if (const auto sent = WorkerLoads::take(*worker, task_id)) {
      workers_.note_answer_time(now - *sent);
    }
    take_from(worker_id, *worker, task_id);
  }
  if (given(worker_id, task_id) == nullptr || is_excluded(worker_id)) {
    ++counts_.ignored;
    return Reception::kUnknown;
  }
  if (is_open(task_id)) {
    const std::size_t index = *batch_.index_of(task_id);
    accept(index, std::move(result), worker_id, now);
    if (audit_is_due(worker, task_id)) audits_.insert(index);
    return Reception::kFirst;
  }
  ++counts_.duplicates;
  if (identical(*find(task_id)->result, result)) return Reception::kDuplicate;
  ++counts_.duplicate_differences;
  const auto add = [&](BoardTask& task) { task.others.emplace_back(worker_id, std::move(result)); };
  if (const auto index = batch_.index_of(task_id)) {
    batch_.change(*index, add);
  } else {
    add(kept_.at(task_id));
  }
  return Reception::kDifferent;
}

void TaskBoard::accept(std::size_t index, MatchResult result, const std::string& worker_id,
                       BoardTime now) {
  batch_.change(index, [&](BoardTask& task) {
    task.result = std::move(result);
    task.answered_by = worker_id;
    task.proven = worker_id.empty();
  });
  recovery_.answered(batch_.at(index).task.task_id, worker_id, now);
}

bool TaskBoard::audit_is_due(Worker* worker, std::uint64_t task_id) const {
  // A worker that has gone since counts as new.
  if (worker == nullptr) return options_.probation > 0;
  if (worker->answers++ < options_.probation) return true;
  if (options_.audit_every == 0) return false;
  support::Fnv1a hash;
  hash.add(task_id);
  constexpr int kUpperHalf = 32;  // better mixed
  return (hash.value() >> kUpperHalf) % options_.audit_every == 0;
}

void TaskBoard::solved(std::size_t index, MatchResult result, BoardTime now) {
  ++counts_.in_process;
  if (!batch_.at(index).result) accept(index, std::move(result), {}, now);
}

std::vector<TaskBoard::Difference> TaskBoard::settle(const MatchResult& truth, BoardTime now) {
  const BoardTask* task = find(truth.task_id);
  if (task == nullptr || !task->result) return {};
  ++counts_.audits;
  std::vector<Difference> differences;
  const auto compare = [&](const std::string& worker_id, const MatchResult& answer) {
    if (identical(answer, truth)) return;
    ++counts_.audit_differences;
    const Worker* worker = workers_.find(worker_id);
    differences.push_back({worker_id, answer, worker == nullptr ? 0 : worker->unchecked});
  };
  if (!task->proven) compare(task->answered_by, *task->result);
  for (const auto& [worker_id, answer] : task->others) compare(worker_id, answer);
  const auto prove = [&](BoardTask& t) {
    t.others.clear();
    t.result = truth;
    t.proven = true;
  };
  if (const auto index = batch_.index_of(truth.task_id)) {
    audits_.erase(*index);
    batch_.change(*index, prove);
  } else {
    prove(kept_.at(truth.task_id));
  }
  for (const Difference& difference : differences) distrust(difference.worker_id, now);
  return differences;
}

void TaskBoard::refuse(const std::string& worker_id, std::uint64_t task_id, Refusal refusal,
                       BoardTime now) {
  Worker* worker = workers_.find(worker_id);
  if (worker == nullptr || !WorkerLoads::take(*worker, task_id)) return;
  worker->last_life = now;
  worker->forgotten = 0;
  take_from(worker_id, *worker, task_id);
  switch (refusal) {
    case Refusal::kMapMissing:
      ++counts_.map_missing;
      worker->rests_until = now + options_.rest;
      break;
    case Refusal::kFailed:
      ++counts_.failed;
      if (is_open(task_id)) {
        batch_.change(*batch_.index_of(task_id), [](BoardTask& task) { task.here_only = true; });
      }
      break;
  }
}

// --- returned tasks

void TaskBoard::take_from(const std::string& worker_id, Worker& worker, std::uint64_t task_id) {
  WorkerLoads::take(worker, task_id);
  const auto index = batch_.index_of(task_id);
  if (index) batch_.change(*index, [&](BoardTask& task) { task.workers.erase(worker_id); });
}

void TaskBoard::take_all_from(const std::string& worker_id, Worker& worker) {
  while (!worker.in_hand.empty()) take_from(worker_id, worker, worker.in_hand.front().task_id);
  holders_.forget(worker_id);
  // If it comes back, it may try them again.
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    if (!batch_.at(i).tried.contains(worker_id)) continue;
    batch_.change(i, [&](BoardTask& task) { task.tried.erase(worker_id); });
  }
}

void TaskBoard::forget_lost(BoardTime now) {
  for (auto& [id, worker] : workers_.all()) {
    if (!workers_.has_forgotten(worker, now)) continue;
    ++worker.forgotten;
    while (!worker.in_hand.empty()) take_from(id, worker, worker.in_hand.front().task_id);
  }
}

void TaskBoard::not_sent(const Assignment& assignment, BoardTime now) {
  const std::uint64_t task_id = batch_.at(assignment.task).task.task_id;
  --counts_.sent;
  if (batch_.at(assignment.task).sends > 1) --counts_.resent;
  batch_.change(assignment.task, [&](BoardTask& task) {
    --task.sends;
    task.workers.erase(assignment.worker_id);
    task.tried.erase(assignment.worker_id);
    task.given.erase(assignment.worker_id);
  });
  Worker* worker = workers_.find(assignment.worker_id);
  if (worker == nullptr) return;
  worker->rests_until = now + options_.rest;
  WorkerLoads::take(*worker, task_id);
}

// --- recovery

std::vector<std::uint64_t> TaskBoard::open_in_hand(const Worker& worker) const {
  std::vector<std::uint64_t> open;
  for (const Worker::InHand& entry : worker.in_hand) {
    if (is_open(entry.task_id)) open.push_back(entry.task_id);
  }
  return open;
}

void TaskBoard::report_stalled(const BoardTask& task) {
  for (const std::string& worker_id : task.workers) {
    const Worker* worker = workers_.find(worker_id);
    if (worker == nullptr || worker->in_hand.empty()) continue;
    recovery_.begin(worker_id, WorkerFault::kStalled, worker->in_hand.front().sent,
                    open_in_hand(*worker));
  }
}

std::vector<Recovery> TaskBoard::take_recoveries() {
  std::vector<Recovery> recoveries = recovery_.take();
  for (const Recovery& recovery : recoveries) {
    counts_.last_recovery = recovery.duration;
    counts_.longest_recovery = std::max(counts_.longest_recovery, recovery.duration);
  }
  return recoveries;
}

}  // namespace topogeo::search_pool
