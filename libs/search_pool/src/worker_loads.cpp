#include "topogeo/search_pool/worker_loads.hpp"

#include <algorithm>

namespace topogeo::search_pool {

namespace {

constexpr std::size_t kAnswerTimes = 65;     // sample of the median
constexpr std::uint64_t kMedianPeriod = 16;  // answers between two medians

bool takes_tasks(const Worker& worker) {
  return worker.present && worker.reachable && !worker.excluded && worker.slots > 0;
}

}  // namespace

WorkerLoads::WorkerLoads(const BoardConfig& options)
    : options_(options), straggler_time_(options.straggler_floor) {}

Worker* WorkerLoads::find(const std::string& worker_id) {
  const auto found = workers_.find(worker_id);
  return found == workers_.end() ? nullptr : &found->second;
}

std::vector<std::string> WorkerLoads::usable() const {
  std::vector<std::string> ids;
  for (const auto& [id, worker] : workers_) {
    if (takes_tasks(worker)) ids.push_back(id);
  }
  return ids;
}

std::size_t WorkerLoads::count_usable() const {
  return static_cast<std::size_t>(std::count_if(
      workers_.begin(), workers_.end(), [](const auto& w) { return takes_tasks(w.second); }));
}

bool WorkerLoads::in_service(const Worker& worker, BoardTime now) const {
  return takes_tasks(worker) && worker.rests_until <= now &&
         (worker.in_hand.empty() || now - worker.in_hand.front().sent < straggler_time_);
}

void WorkerLoads::set_open_tasks(std::size_t open) {
  std::size_t slots = 0;
  for (const auto& [id, worker] : workers_) {
    if (takes_tasks(worker)) slots += worker.slots;
  }
  constexpr std::size_t kPartOfShare = 2;
  share_per_slot_ = std::clamp<std::size_t>(
      open / std::max<std::size_t>(1, kPartOfShare * slots), options_.tasks_per_slot,
      std::max(options_.tasks_per_slot, options_.most_tasks_per_slot));
}

bool WorkerLoads::has_room(const Worker& worker) const {
  const bool is_new = worker.answers < options_.probation;
  const std::size_t per_slot = is_new ? options_.tasks_per_slot : share_per_slot_;
  return worker.in_hand.size() <
         std::min(worker.slots * per_slot, std::size_t{options_.tasks_per_worker});
}

WorkerLoads::Workers::value_type* WorkerLoads::choose(const std::set<std::string>& tried,
                                                      BoardTime now) {
  Workers::value_type* best = nullptr;
  for (auto& entry : workers_) {
    const Worker& worker = entry.second;
    if (!has_room(worker) || !in_service(worker, now)) continue;
    if (best != nullptr &&
        worker.in_hand.size() * best->second.slots >= best->second.in_hand.size() * worker.slots) {
      continue;
    }
    if (!tried.contains(entry.first)) best = &entry;
  }
  return best;
}

bool WorkerLoads::any_in_service(const std::set<std::string>& tried, BoardTime now) const {
  return std::any_of(workers_.begin(), workers_.end(), [&](const auto& entry) {
    return in_service(entry.second, now) && !tried.contains(entry.first);
  });
}

std::optional<BoardTime> WorkerLoads::take(Worker& worker, std::uint64_t task_id) {
  const auto found = std::find_if(worker.in_hand.begin(), worker.in_hand.end(),
                                  [&](const auto& entry) { return entry.task_id == task_id; });
  if (found == worker.in_hand.end()) return {};
  const BoardTime sent = found->sent;
  worker.in_hand.erase(found);
  return sent;
}

void WorkerLoads::note_answer_time(BoardTime time) {
  answer_times_.push_back(time);
  const bool few = answer_times_.size() <= kAnswerTimes;
  if (!few) answer_times_.pop_front();
  if (++answers_noted_ % kMedianPeriod != 0 && !few) return;
  std::vector<BoardTime> sorted(answer_times_.begin(), answer_times_.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  straggler_time_ =
      std::max(options_.straggler_floor,
               std::chrono::duration_cast<BoardTime>(
                   std::chrono::duration<double, std::nano>(*middle) * options_.straggler_factor));
}

std::optional<BoardTime> WorkerLoads::next_straggler(BoardTime now) const {
  std::optional<BoardTime> first;
  for (const auto& [id, worker] : workers_) {
    for (const Worker::InHand& entry : worker.in_hand) {
      const BoardTime due = entry.sent + straggler_time_;
      if (due <= now) continue;
      if (!first || due < *first) first = due;
      break;  // later ones are due later
    }
  }
  return first;
}

bool WorkerLoads::has_forgotten(const Worker& worker, BoardTime now) const {
  BoardTime after = options_.forget_after;
  for (std::uint32_t n = 0; n < worker.forgotten && after < options_.longest_forget_after; ++n) {
    after = std::min(2 * after, options_.longest_forget_after);
  }
  return !worker.in_hand.empty() &&
         now - worker.in_hand.front().sent >= std::max(after, 2 * straggler_time_);
}

}  // namespace topogeo::search_pool
