#include "task_runner.hpp"

#include <stdexcept>

namespace topogeo::ga_worker {

TaskRunner::TaskRunner(std::size_t slots, std::chrono::nanoseconds map_patience,
                       OutcomeHandler on_outcome)
    : map_patience_(map_patience), on_outcome_(std::move(on_outcome)) {
  if (slots == 0) throw std::invalid_argument("slots: 0, allowed is 1 or more");
  threads_.reserve(slots);
  for (std::size_t i = 0; i < slots; ++i) threads_.emplace_back([this] { work(); });
}

TaskRunner::~TaskRunner() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void TaskRunner::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  const std::uint64_t hash = topomap::content_hash(*map);
  std::pair<std::string, std::uint32_t> key{map->robot_id, map->id};
  const std::lock_guard lock(mutex_);
  maps_[std::move(key)] = {hash, std::move(map)};
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    std::optional<Ready> ready = make_ready(it->job);
    if (!ready) {
      ++it;
      continue;
    }
    ready_.push_back(std::move(*ready));
    it = waiting_.erase(it);
    changed_.notify_one();
  }
}

void TaskRunner::add(Job job) {
  {
    const std::lock_guard lock(mutex_);
    ++in_hand_;
    if (std::optional<Ready> ready = make_ready(job)) {
      ready_.push_back(std::move(*ready));
    } else {
      waiting_.push_back({std::move(job), Clock::now() + map_patience_});
    }
  }
  changed_.notify_one();
}

std::size_t TaskRunner::in_hand() const {
  const std::lock_guard lock(mutex_);
  return in_hand_;
}

std::size_t TaskRunner::maps_held() const {
  const std::lock_guard lock(mutex_);
  return maps_.size();
}

std::chrono::nanoseconds TaskRunner::busy_time() const {
  const std::lock_guard lock(mutex_);
  return busy_;
}

std::shared_ptr<const topomap::LocalMap> TaskRunner::held(const std::string& robot_id,
                                                          std::uint32_t id,
                                                          std::uint64_t hash) const {
  const auto found = maps_.find({robot_id, id});
  return found == maps_.end() || found->second.hash != hash ? nullptr : found->second.map;
}

std::optional<TaskRunner::Ready> TaskRunner::make_ready(Job& job) const {
  auto reference = held(job.robot_id, job.task.reference_map_id, job.task.reference_hash);
  auto query = held(job.robot_id, job.task.query_map_id, job.task.query_hash);
  if (!reference || !query) return {};
  return Ready{std::move(job), std::move(reference), std::move(query)};
}

std::optional<TaskRunner::Ready> TaskRunner::next_job(bool& missing) {
  missing = false;
  std::unique_lock lock(mutex_);
  while (true) {
    if (stopping_) return {};
    if (!ready_.empty()) {
      Ready ready = std::move(ready_.front());
      ready_.pop_front();
      return ready;
    }
    if (waiting_.empty()) {
      changed_.wait(lock);
    } else if (const Clock::time_point until = waiting_.front().until; Clock::now() >= until) {
      Ready ready{std::move(waiting_.front().job), nullptr, nullptr};
      waiting_.pop_front();
      missing = true;
      return ready;
    } else {
      changed_.wait_until(lock, until);
    }
  }
}

void TaskRunner::work() {
  Matchers matchers;
  bool missing = false;
  while (std::optional<Ready> ready = next_job(missing)) {
    const Clock::time_point start = Clock::now();
    Outcome outcome;
    if (missing) {
      outcome.failure = Failure::kMapMissing;
      outcome.message = "map " + std::to_string(ready->job.task.reference_map_id) + " or " +
                        std::to_string(ready->job.task.query_map_id) + " did not come";
    } else {
      outcome = solve(matchers, *ready);
    }
    outcome.ticket = ready->job.ticket;
    {
      const std::lock_guard lock(mutex_);
      --in_hand_;
      busy_ += Clock::now() - start;
    }
    on_outcome_(std::move(outcome));
  }
}

TaskRunner::Outcome TaskRunner::solve(Matchers& matchers, const Ready& ready) {
  Outcome outcome;
  try {
    localization::Matcher& matcher = matchers[ready.job.robot_id];
    const localization::MatchTask& task = ready.job.task;
    if (!matcher.has_map(task.reference_map_id, task.reference_hash)) {
      matcher.add_map(*ready.reference);
    }
    if (!matcher.has_map(task.query_map_id, task.query_hash)) matcher.add_map(*ready.query);
    outcome.result = matcher.solve(task);
  } catch (const std::exception& error) {
    outcome.failure = Failure::kFailed;
    outcome.message = error.what();
  }
  return outcome;
}

}  // namespace topogeo::ga_worker
