#include "task_board.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

namespace topogeo::localizer {

using localization::MatchResult;
using localization::MatchTask;

namespace {

constexpr std::size_t kAnswerTimes = 65;      // of which the median is taken
constexpr std::size_t kResentAnswers = 1024;  // kept to compare late answers with

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const geometry::Pose2& a, const geometry::Pose2& b) {
  return same(a.x_m, b.x_m) && same(a.y_m, b.y_m) && same(a.theta_rad, b.theta_rad);
}

}  // namespace

bool identical(const MatchResult& a, const MatchResult& b) {
  return a.task_id == b.task_id && a.status == b.status && a.evaluations == b.evaluations &&
         std::equal(a.solutions.begin(), a.solutions.end(), b.solutions.begin(), b.solutions.end(),
                    [](const auto& x, const auto& y) {
                      return same(x.T_reference_query, y.T_reference_query) &&
                             same(x.fitness, y.fitness);
                    }) &&
         same(a.T_reference_query, b.T_reference_query) &&
         std::equal(a.information.data(), a.information.data() + a.information.size(),
                    b.information.data(), [](double x, double y) { return same(x, y); }) &&
         same(a.overlap, b.overlap) && same(a.inliers, b.inliers) &&
         same(a.violations, b.violations) && same(a.residual_rms_m, b.residual_rms_m) &&
         same(a.scan_fitness, b.scan_fitness) &&
         same(a.topological_fitness, b.topological_fitness) && same(a.fitness, b.fitness) &&
         same(a.second_fitness, b.second_fitness);
}

TaskBoard::TaskBoard(const BoardOptions& options)
    : options_(options), straggler_time_(options.straggler_floor) {}

// --- workers

void TaskBoard::worker_up(const std::string& worker_id, std::uint32_t slots,
                          std::uint64_t incarnation) {
  Worker& worker = workers_[worker_id];
  if (worker.incarnation != incarnation) {
    if (worker.present) lose(worker_id, worker);
    worker.excluded = false;
  }
  worker.present = true;
  worker.incarnation = incarnation;
  worker.slots = slots;
}

void TaskBoard::worker_gone(const std::string& worker_id) {
  const auto found = workers_.find(worker_id);
  if (found == workers_.end()) return;
  lose(worker_id, found->second);
  if (!found->second.excluded) {
    workers_.erase(found);
    return;
  }
  found->second.present = false;
  found->second.reachable = false;
}

bool TaskBoard::exclude(const std::string& worker_id) {
  Worker& worker = workers_[worker_id];
  if (worker.excluded) return false;
  worker.excluded = true;
  take_all_from(worker_id, worker);
  return true;
}

void TaskBoard::set_reachable(const std::string& worker_id, bool reachable) {
  const auto found = workers_.find(worker_id);
  if (found != workers_.end()) found->second.reachable = reachable;
}

std::size_t TaskBoard::workers() const {
  return static_cast<std::size_t>(
      std::count_if(workers_.begin(), workers_.end(), [](const auto& id_and_worker) {
        const Worker& worker = id_and_worker.second;
        return worker.present && worker.reachable && !worker.excluded && worker.slots > 0;
      }));
}

bool TaskBoard::in_service(const Worker& worker, BoardTime now) const {
  if (!worker.present || !worker.reachable || worker.excluded || worker.slots == 0) return false;
  if (worker.rests_until > now) return false;
  return std::none_of(worker.in_hand.begin(), worker.in_hand.end(), [&](const auto& id_and_sent) {
    return now - id_and_sent.second >= straggler_time_;
  });
}

bool TaskBoard::has_room(const Worker& worker) const {
  return worker.in_hand.size() < std::min(std::size_t{worker.slots} * options_.tasks_per_slot,
                                          std::size_t{options_.tasks_per_worker});
}

// --- batches

void TaskBoard::begin(std::span<const MatchTask> tasks) {
  if (!done()) throw std::logic_error("task board: the last batch is not done");
  abandon();
  tasks_.resize(tasks.size());
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    tasks_[i].id = tasks[i].task_id;
    if (!index_.emplace(tasks[i].task_id, i).second) {
      abandon();
      throw std::logic_error("task board: task " + std::to_string(tasks[i].task_id) +
                             " is twice in a batch");
    }
    waiting_.insert(i);
  }
  open_ = tasks.size();
}

void TaskBoard::abandon() {
  tasks_.clear();
  index_.clear();
  waiting_.clear();
  out_.clear();
  open_ = 0;
}

std::vector<MatchResult> TaskBoard::take_results() {
  if (!done()) throw std::logic_error("task board: the batch is not done");
  std::vector<MatchResult> results;
  results.reserve(tasks_.size());
  for (Task& task : tasks_) {
    keep_for_comparison(task);
    results.push_back(std::move(*task.result));
  }
  abandon();
  return results;
}

// --- what to do next

bool TaskBoard::straggles(const Task& task, BoardTime now) const {
  return now - task.last_sent >= straggler_time_;
}

TaskBoard::Workers::iterator TaskBoard::choose(const Task& task, BoardTime now) {
  auto best = workers_.end();
  for (auto it = workers_.begin(); it != workers_.end(); ++it) {
    const Worker& worker = it->second;
    if (!has_room(worker) || !in_service(worker, now) || task.tried.contains(it->first)) continue;
    if (best == workers_.end() ||
        worker.in_hand.size() * best->second.slots < best->second.in_hand.size() * worker.slots) {
      best = it;
    }
  }
  return best;
}

bool TaskBoard::worth_waiting(const Task& task, BoardTime now) const {
  return !task.here_only &&
         std::any_of(workers_.begin(), workers_.end(), [&](const auto& id_and_worker) {
           return in_service(id_and_worker.second, now) &&
                  !task.tried.contains(id_and_worker.first);
         });
}

TaskBoard::Assignment TaskBoard::assign(std::size_t index, Workers::iterator worker,
                                        BoardTime now) {
  Task& task = tasks_[index];
  worker->second.in_hand[task.id] = now;
  task.workers.insert(worker->first);
  task.tried.insert(worker->first);
  task.last_sent = now;
  ++counts_.sent;
  if (task.sends++ > 0) ++counts_.resent;
  waiting_.erase(index);
  out_.insert(index);
  return {index, worker->first};
}

std::optional<TaskBoard::Assignment> TaskBoard::next_remote(BoardTime now) {
  forget_lost(now);
  for (const std::size_t index : waiting_) {
    const Task& task = tasks_[index];
    if (task.here_only) continue;
    const auto worker = choose(task, now);
    if (worker != workers_.end()) return assign(index, worker, now);
    if (task.tried.empty()) break;  // nobody has room for the others either
  }
  for (const std::size_t index : out_) {
    if (!straggles(tasks_[index], now)) continue;
    const auto worker = choose(tasks_[index], now);
    if (worker != workers_.end()) return assign(index, worker, now);
  }
  return {};
}

std::optional<std::size_t> TaskBoard::next_local(BoardTime now) {
  for (const std::size_t index : waiting_) {
    if (!worth_waiting(tasks_[index], now)) return index;
  }
  for (const std::size_t index : out_) {
    if (straggles(tasks_[index], now)) return index;
  }
  return {};
}

std::optional<BoardTime> TaskBoard::next_deadline(BoardTime now) const {
  std::optional<BoardTime> first;
  for (const auto& [id, worker] : workers_) {
    for (const auto& [task, sent] : worker.in_hand) {
      const BoardTime due = sent + straggler_time_;
      if (due > now && (!first || due < *first)) first = due;
    }
  }
  return first;
}

// --- answers

TaskBoard::Task* TaskBoard::find(std::uint64_t task_id) {
  const auto found = index_.find(task_id);
  return found == index_.end() ? nullptr : &tasks_[found->second];
}

void TaskBoard::take_from(const std::string& worker_id, Worker& worker, std::uint64_t task_id) {
  worker.in_hand.erase(task_id);
  Task* task = find(task_id);
  if (task == nullptr) return;
  task->workers.erase(worker_id);
  if (!task->result && task->workers.empty()) {
    out_.erase(index_.at(task_id));
    waiting_.insert(index_.at(task_id));
  }
}

void TaskBoard::lose(const std::string& worker_id, Worker& worker) {
  if (!worker.in_hand.empty()) ++counts_.workers_lost;
  take_all_from(worker_id, worker);
}

void TaskBoard::take_all_from(const std::string& worker_id, Worker& worker) {
  while (!worker.in_hand.empty()) {
    const std::uint64_t task_id = worker.in_hand.begin()->first;
    take_from(worker_id, worker, task_id);
  }
  // Should it come back, it has a fresh chance.
  for (Task& task : tasks_) task.tried.erase(worker_id);
}

void TaskBoard::forget_lost(BoardTime now) {
  for (auto& [id, worker] : workers_) {
    std::vector<std::uint64_t> lost;
    for (const auto& [task, sent] : worker.in_hand) {
      if (now - sent >= std::max(options_.forget_after, 2 * straggler_time_)) lost.push_back(task);
    }
    for (const std::uint64_t task : lost) take_from(id, worker, task);
  }
}

void TaskBoard::note_answer_time(BoardTime time) {
  answer_times_.push_back(time);
  if (answer_times_.size() > kAnswerTimes) answer_times_.pop_front();
  std::vector<BoardTime> sorted(answer_times_.begin(), answer_times_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  straggler_time_ =
      std::max(options_.straggler_floor,
               std::chrono::duration_cast<BoardTime>(
                   std::chrono::duration<double, std::nano>(*middle) * options_.straggler_factor));
}

Reception TaskBoard::answer(const std::string& worker_id, const MatchResult& result,
                            BoardTime now) {
  const auto found = workers_.find(worker_id);
  if (found != workers_.end()) {
    if (found->second.excluded) return Reception::kUnknown;
    const auto sent = found->second.in_hand.find(result.task_id);
    if (sent != found->second.in_hand.end()) {
      note_answer_time(now - sent->second);
      take_from(worker_id, found->second, result.task_id);
    }
  }
  return receive(result.task_id, result);
}

Reception TaskBoard::receive(std::uint64_t task_id, const MatchResult& result) {
  Task* task = find(task_id);
  if (task != nullptr && !task->result) {
    task->result = result;
    waiting_.erase(index_.at(task_id));
    out_.erase(index_.at(task_id));
    --open_;
    return Reception::kFirst;
  }
  const MatchResult* first = nullptr;
  if (task != nullptr) {
    first = &*task->result;
  } else if (const auto kept = resent_answers_.find(task_id); kept != resent_answers_.end()) {
    first = &kept->second;
  }
  if (first == nullptr) return Reception::kUnknown;
  ++counts_.duplicates;
  if (identical(*first, result)) return Reception::kDuplicate;
  ++counts_.duplicate_differences;
  return Reception::kDifferent;
}

void TaskBoard::keep_for_comparison(const Task& task) {
  // Another answer may come from somebody who got the task and did not give the one that counts.
  if (task.sends < (task.solved_here ? 1U : 2U)) return;
  resent_answers_[task.id] = *task.result;
  if (resent_answers_.size() > kResentAnswers) resent_answers_.erase(resent_answers_.begin());
}

void TaskBoard::refuse(const std::string& worker_id, std::uint64_t task_id, Refusal refusal,
                       BoardTime now) {
  const auto found = workers_.find(worker_id);
  if (found == workers_.end() || !found->second.in_hand.contains(task_id)) return;
  take_from(worker_id, found->second, task_id);
  switch (refusal) {
    case Refusal::kMapMissing:
      ++counts_.map_missing;
      found->second.rests_until = now + options_.rest;
      break;
    case Refusal::kOtherVersion:
      static_cast<void>(exclude(worker_id));
      break;
    case Refusal::kFailed:
      ++counts_.failed;
      if (Task* task = find(task_id)) task->here_only = true;
      break;
  }
}

Reception TaskBoard::solved(std::size_t task, const MatchResult& result) {
  ++counts_.in_process;
  const Reception reception = receive(tasks_.at(task).id, result);
  tasks_[task].solved_here = reception == Reception::kFirst;
  return reception;
}

void TaskBoard::not_sent(const Assignment& assignment, BoardTime now) {
  Task& task = tasks_.at(assignment.task);
  --counts_.sent;
  if (--task.sends > 0) --counts_.resent;
  task.tried.erase(assignment.worker_id);
  const auto worker = workers_.find(assignment.worker_id);
  if (worker == workers_.end()) return;
  worker->second.rests_until = now + options_.rest;
  take_from(assignment.worker_id, worker->second, task.id);
}

}  // namespace topogeo::localizer
