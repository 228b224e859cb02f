#include "topogeo/search_pool/task_intake.hpp"

#include <algorithm>
#include <set>

#include "topogeo/support/format.hpp"

namespace topogeo::search_pool {

namespace {

/// Robots whose newest maps are stored. Dropping one costs a wait.
constexpr std::size_t kMostRobots = 64;
/// Maps stored per robot. Tasks name the newest, and the one or two before.
constexpr std::size_t kNewestMaps = 4;

bool is_complete(const ReadyJob& job) {
  if (!job.job.task.places) return job.reference && job.query;
  return std::ranges::find(job.pieces, nullptr) == job.pieces.end();
}

/// Gives the job a map that it lacks. True if the job lacked it.
bool give(ReadyJob& job, std::uint64_t hash, const MapPointer& map) {
  const localization::MatchTask& task = job.job.task;
  bool wanted = false;
  const auto take = [&](std::uint64_t meant, MapPointer& to) {
    if (meant != hash) return;
    to = map;
    wanted = true;
  };
  if (!task.places) {
    take(task.reference_hash, job.reference);
    take(task.query_hash, job.query);
    return wanted;
  }
  for (std::size_t i = 0; i < job.pieces.size(); ++i) {
    take(task.places->pieces[i].content_hash, job.pieces[i]);
  }
  return wanted;
}

}  // namespace

template <class Action>
void TaskIntake::for_each_lack(const ReadyJob& job, Action action) {
  const localization::MatchTask& task = job.job.task;
  if (task.places) {
    for (std::size_t i = 0; i < job.pieces.size(); ++i) {
      const auto& piece = task.places->pieces[i];
      if (!job.pieces[i]) action(Lack{job.job.client_id, piece.content_hash}, piece.map_id);
    }
    return;
  }
  if (!job.reference) action(Lack{job.job.client_id, task.reference_hash}, task.reference_map_id);
  if (!job.query) action(Lack{job.job.client_id, task.query_hash}, task.query_map_id);
}

std::optional<ReadyJob> TaskIntake::add(MatchJob job, Time now) {
  ReadyJob ready{std::move(job), {}, {}, {}};
  const localization::MatchTask& task = ready.job.task;
  if (task.places) {
    for (const auto& piece : task.places->pieces) {
      ready.pieces.push_back(maps_.find(piece.content_hash));
    }
  } else {
    ready.reference = find(ready.job, task.reference_map_id, task.reference_hash);
    ready.query = find(ready.job, task.query_map_id, task.query_hash);
  }
  if (is_complete(ready)) return ready;
  const std::uint32_t newest = std::max(task.reference_map_id, task.query_map_id);
  for_each_lack(ready, [&](const Lack& lack, std::uint32_t map_id) {
    const bool may_come = !task.places && map_id == newest && !is_past(ready.job);
    const Time due = may_come ? now + options_.first_request : now;
    Asking& asking = requested_.try_emplace(lack, Asking{due, false}).first->second;
    if (!asking.asked) asking.next = std::min(asking.next, due);
  });
  waiting_.push_back({std::move(ready), now + options_.patience});
  return {};
}

MapPointer TaskIntake::find(const MatchJob& job, std::uint32_t map_id, std::uint64_t hash) {
  MapPointer map = maps_.find(hash);
  return map ? map : find_by_other_number(job.robot_id, map_id, hash);
}

MapPointer TaskIntake::find_by_other_number(const std::string& robot_id, std::uint32_t map_id,
                                            std::uint64_t hash) {
  const auto published = published_.find(robot_id);
  if (published == published_.end()) return nullptr;
  for (const MapPointer& map : published->second) {
    if (MapPointer meant = numbered_as_meant(*map, map_id, hash)) return meant;
  }
  return nullptr;
}

MapPointer TaskIntake::numbered_as_meant(const topomap::LocalMap& map, std::uint32_t map_id,
                                         std::uint64_t hash) {
  if (topomap::content_hash(map, map_id) != hash) return nullptr;
  auto numbered = std::make_shared<const topomap::LocalMap>(topomap::numbered(map, map_id, false));
  maps_.add(hash, numbered);
  return numbered;
}

std::vector<ReadyJob> TaskIntake::add_published(MapPointer map) {
  const std::string robot_id = map->robot_id;
  if (published_.size() >= kMostRobots && !published_.contains(robot_id)) published_.clear();
  std::deque<MapPointer>& published = published_[robot_id];
  published.push_front(map);
  if (published.size() > kNewestMaps) published.pop_back();
  std::vector<ReadyJob> ready = add_map(std::move(map));
  std::set<std::pair<std::uint32_t, std::uint64_t>> lacking;  // number and content
  for (const Waiting& waiting : waiting_) {
    if (waiting.job.job.task.places || waiting.job.job.robot_id != robot_id) continue;
    for_each_lack(waiting.job, [&](const Lack& lack, std::uint32_t map_id) {
      lacking.emplace(map_id, lack.second);
    });
  }
  for (const auto& [map_id, hash] : lacking) {
    MapPointer numbered = numbered_as_meant(*published.front(), map_id, hash);
    if (!numbered) continue;
    for (ReadyJob& job : add_map(std::move(numbered))) ready.push_back(std::move(job));
  }
  return ready;
}

// A map of this time has arrived, and it is not the named one. The last map defines the time, not
// the newest stamp, because a log may be driven again.
bool TaskIntake::is_past(const MatchJob& job) const {
  const auto published = published_.find(job.robot_id);
  return published != published_.end() && published->second.front()->stamp_ns >= job.stamp_ns;
}

std::vector<ReadyJob> TaskIntake::add_map(MapPointer map) {
  const std::uint64_t hash = topomap::content_hash(*map);
  std::vector<ReadyJob> ready;
  bool wanted = false;
  for (auto it = waiting_.begin(); it != waiting_.end();) {
    ReadyJob& job = it->job;
    wanted |= give(job, hash, map);
    if (is_complete(job)) {
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
    due.given_up.push_back({std::move(job.job), "local map " + missing + " did not arrive"});
    waiting_.pop_front();
  }
  if (!due.given_up.empty()) forget_requests();
  for (const Waiting& waiting : waiting_) {
    for_each_lack(waiting.job, [&](const Lack& lack, std::uint32_t map_id) {
      Asking& asking = requested_.at(lack);
      if (asking.next > now) return;
      asking = {now + options_.request_period, true};
      due.requests.push_back(
          {lack.first, waiting.job.job.robot_id, waiting.job.job.stamp_ns, map_id, lack.second});
    });
  }
  return due;
}

std::optional<TaskIntake::Time> TaskIntake::next_check() const {
  if (waiting_.empty()) return {};
  Time next = waiting_.front().until;
  for (const auto& [lack, asking] : requested_) next = std::min(next, asking.next);
  return next;
}

void TaskIntake::remove(const std::string& client_id) {
  waiting_.remove_if(
      [&](const Waiting& waiting) { return waiting.job.job.client_id == client_id; });
  forget_requests();
}

void TaskIntake::forget_requests() {
  std::set<Lack> lacking;
  for (const Waiting& waiting : waiting_) {
    for_each_lack(waiting.job, [&](const Lack& lack, std::uint32_t) { lacking.insert(lack); });
  }
  std::erase_if(requested_, [&](const auto& entry) { return !lacking.contains(entry.first); });
}

}  // namespace topogeo::search_pool
