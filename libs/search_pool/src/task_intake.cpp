#include "topogeo/search_pool/task_intake.hpp"

#include <algorithm>
#include <set>

#include "topogeo/support/format.hpp"

namespace topogeo::search_pool {

template <class Action>
void TaskIntake::for_each_lack(const ReadyJob& job, Action action) {
  const localization::MatchTask& task = job.job.task;
  if (!job.reference) action(Lack{job.job.client_id, task.reference_hash}, task.reference_map_id);
  if (!job.query) action(Lack{job.job.client_id, task.query_hash}, task.query_map_id);
}

std::optional<ReadyJob> TaskIntake::add(MatchJob job, Time now) {
  MapPointer reference = maps_.find(job.task.reference_hash);
  MapPointer query = maps_.find(job.task.query_hash);
  ReadyJob ready{std::move(job), std::move(reference), std::move(query)};
  if (ready.reference && ready.query) return ready;
  for_each_lack(ready, [&](const Lack& lack, std::uint32_t /*map_id*/) {
    requested_.try_emplace(lack, now + options_.first_request);
  });
  waiting_.push_back({std::move(ready), now + options_.patience});
  return {};
}

std::vector<ReadyJob> TaskIntake::add_map(MapPointer map) {
  const std::uint64_t hash = topomap::content_hash(*map);
  std::vector<ReadyJob> ready;
  bool wanted = false;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    ReadyJob& job = it->job;
    const localization::MatchTask& task = job.job.task;
    if (task.reference_hash == hash) job.reference = map;
    if (task.query_hash == hash) job.query = map;
    wanted = wanted || task.reference_hash == hash || task.query_hash == hash;
    if (job.reference && job.query) {
      ready.push_back(std::move(job));
      it = waiting_.erase(it);
    } else {
      ++it;
    }
  }
  maps_.add(hash, std::move(map));
  if (wanted) forget_requests();
  return ready;
}

bool TaskIntake::lacks(std::uint64_t content_hash) const {
  return std::any_of(requested_.begin(), requested_.end(),
                     [&](const auto& entry) { return entry.first.second == content_hash; });
}

TaskIntake::Due TaskIntake::check(Time now) {
  Due due;
  while (!waiting_.empty() && waiting_.front().until <= now) {
    ReadyJob& job = waiting_.front().job;
    std::string missing;
    for_each_lack(job, [&](const Lack& lack, std::uint32_t map_id) {
      missing += fmt::format("{}{} ({:016x})", missing.empty() ? "" : " and ", map_id, lack.second);
    });
    due.given_up.push_back({std::move(job.job), "local map " + missing + " did not come"});
    waiting_.pop_front();
  }
  if (!due.given_up.empty()) forget_requests();
  for (const Waiting& waiting : waiting_) {
    for_each_lack(waiting.job, [&](const Lack& lack, std::uint32_t map_id) {
      Time& next = requested_.at(lack);
      if (next > now) return;
      next = now + options_.request_period;
      due.requests.push_back(
          {lack.first, waiting.job.job.robot_id, waiting.job.job.stamp_ns, map_id, lack.second});
    });
  }
  return due;
}

std::optional<TaskIntake::Time> TaskIntake::next_check() const {
  if (waiting_.empty()) return {};
  Time next = waiting_.front().until;
  for (const auto& [lack, time] : requested_) next = std::min(next, time);
  return next;
}

std::vector<std::uint64_t> TaskIntake::remove(const std::string& client_id) {
  std::vector<std::uint64_t> tickets;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    if (it->job.job.client_id != client_id) {
      ++it;
      continue;
    }
    tickets.push_back(it->job.job.ticket);
    it = waiting_.erase(it);
  }
  forget_requests();
  return tickets;
}

void TaskIntake::forget_requests() {
  std::set<Lack> lacking;
  for (const Waiting& waiting : waiting_) {
    for_each_lack(waiting.job, [&](const Lack& lack, std::uint32_t) { lacking.insert(lack); });
  }
  std::erase_if(requested_, [&](const auto& entry) { return !lacking.contains(entry.first); });
}

}  // namespace topogeo::search_pool
