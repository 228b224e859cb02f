#include "remote_pool.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/hash.hpp"

namespace topogeo::localizer {

using localization::MatchResult;
using localization::MatchTask;

namespace {

/// Longest wait for an event that wakes the pool anyway.
constexpr std::chrono::seconds kLongestWait{1};

/// Workers tell their status every 500 ms; one that is silent for a second is gone. Liveliness of
/// DDS alone does not do: while any other worker lives, Fast DDS 2.9 takes the dead one to live,
/// too, until the lease of its participant ends (upstream report 4373). Ticks of the loop are
/// counted and not time, so that a loop that stood still takes nobody to be gone.
constexpr std::chrono::milliseconds kTick{125};
constexpr int kSilentTicks = 9;

BoardTime now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// Tells two processes apart that run under one worker id.
std::uint64_t incarnation(const msg::WorkerStatus& status) {
  support::Fnv1a hash;
  hash.add(std::string(status.host().to_string()));
  hash.add(std::uint64_t{status.process_id()});
  return hash.value();
}

}  // namespace

RemotePool::RemotePool(const messaging::Participant& participant, messaging::EventLoop& loop,
                       RemotePoolOptions options, FaultHandler on_fault)
    : loop_(loop),
      options_(std::move(options)),
      on_fault_(std::move(on_fault)),
      board_(options_.board),
      statuses_(participant),
      results_(participant, {{}, {"client_id = %0", {"'" + options_.client_id + "'"}}}),
      task_writer_(participant) {
  loop_.on_event([this](const messaging::Event& event) { on_event(event); });
  loop_.add<msg::WorkerStatus>(
      statuses_,
      [this](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
        on_status(status, info);
      },
      [this](const messaging::SampleInfo& info) { on_worker_gone(info); });
  loop_.add<msg::MatchResult>(
      results_, [this](const msg::MatchResult& message, const messaging::SampleInfo&) {
        on_result(message);
      });
  loop_.add(task_writer_);
  timer_ = loop_.add_timer(kTick, [this] { drop_silent_workers(); });
}

RemotePool::~RemotePool() {
  loop_.cancel_timer(timer_);
}

void RemotePool::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  const std::uint32_t id = map->id;
  maps_[id] = std::move(map);
}

// --- the wait

std::vector<MatchResult> RemotePool::match(std::span<const MatchTask> tasks) {
  board_.begin(tasks);
  batch_ = tasks;
  try {
    while (!board_.done()) {
      send_waiting();
      if (const std::optional<std::size_t> here = board_.next_local(now())) {
        report(board_.solved(*here, solve(batch_[*here])), "this process", batch_[*here].task_id);
        run_loop(std::chrono::nanoseconds::zero(), {});
        continue;
      }
      if (board_.done()) break;
      const BoardTime time = now();
      const BoardTime due = board_.next_deadline(time).value_or(time + kLongestWait);
      run_loop(std::min<BoardTime>(due - time, kLongestWait),
               [this] { return board_.done() || board_.next_local(now()).has_value(); });
    }
  } catch (...) {
    board_.abandon();
    batch_ = {};
    throw;
  }
  batch_ = {};
  return board_.take_results();
}

std::size_t RemotePool::wait_for_workers(std::size_t count, std::chrono::nanoseconds patience) {
  if (board_.workers() < count) {
    run_loop(patience, [this, count] { return board_.workers() >= count; });
  }
  return board_.workers();
}

void RemotePool::run_loop(std::chrono::nanoseconds duration, const std::function<bool()>& until) {
  until_ = until;
  woken_ = false;
  const bool ended = loop_.run_for(duration);
  until_ = {};
  if ((ended && !woken_) || (options_.stopping && options_.stopping())) {
    loop_.stop();  // the one that this runs in, too
    throw Stopped();
  }
}

void RemotePool::go_on() {
  send_waiting();
  if (until_ && !woken_ && until_()) {
    woken_ = true;
    loop_.stop();
  }
}

// --- tasks out

void RemotePool::send_waiting() {
  if (batch_.empty()) return;
  while (const std::optional<TaskBoard::Assignment> next = board_.next_remote(now())) {
    if (send(*next)) continue;
    board_.not_sent(*next, now());
    on_fault_("task not sent", "the history of worker " + next->worker_id + " is full");
  }
}

bool RemotePool::send(const TaskBoard::Assignment& assignment) {
  const MatchTask& task = batch_[assignment.task];
  service::MatchAddress address;
  address.robot_id = options_.robot_id;
  address.stamp_ns = maps_.at(task.query_map_id)->stamp_ns;
  address.sequence_number = sequence_++;
  address.worker_id = assignment.worker_id;
  address.client_id = options_.client_id;
  address.version = options_.version;
  address.config_fingerprint = options_.config_fingerprint;
  return task_writer_.write(service::to_msg(task, address));
}

MatchResult RemotePool::solve(const MatchTask& task) {
  for (const auto& [id, hash] : {std::pair{task.reference_map_id, task.reference_hash},
                                 std::pair{task.query_map_id, task.query_hash}}) {
    const auto found = maps_.find(id);
    if (found != maps_.end() && !matcher_.has_map(id, hash)) matcher_.add_map(*found->second);
  }
  return matcher_.solve(task);
}

// --- answers in

void RemotePool::on_result(const msg::MatchResult& message) {
  const std::string worker_id = message.worker_id().to_string();
  const std::uint64_t task_id = message.task_id();
  const auto refuse = [&](Refusal refusal) { board_.refuse(worker_id, task_id, refusal, now()); };
  switch (message.status()) {
    case msg::kMatchSolved:
    case msg::kMatchNothingInCommon:
      try {
        report(board_.answer(worker_id, service::from_msg(message), now()), worker_id, task_id);
      } catch (const std::invalid_argument& error) {
        on_fault_("bad match result", worker_id + ": " + error.what());
        refuse(Refusal::kFailed);
      }
      break;
    case msg::kMatchMapMissing:
      refuse(Refusal::kMapMissing);
      break;
    case msg::kMatchOtherVersion:
      exclude(worker_id, message.message().to_string());
      break;
    case msg::kMatchFailed:
      on_fault_("task failed", worker_id + ": " + message.message().to_string());
      refuse(Refusal::kFailed);
      break;
  }
  go_on();
}

void RemotePool::report(Reception reception, const std::string& worker_id, std::uint64_t task_id) {
  if (reception != Reception::kDifferent) return;
  on_fault_("different answers to a task",
            "task " + std::to_string(task_id) + ", second answer from " + worker_id);
}

// --- workers

void RemotePool::on_status(const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
  const std::string robot_id = status.robot_id().to_string();
  if (!robot_id.empty() && robot_id != options_.robot_id) return;
  const std::string worker_id = status.worker_id().to_string();
  const std::string version = status.version().to_string();
  if (version != options_.version) {
    exclude(worker_id, "version " + version + ", this is " + options_.version);
    return;
  }
  const KnownWorker worker{worker_id, service::participant_of(info.writer), 0};
  known_[info.instance] = worker;
  board_.worker_up(worker_id, status.slots(), incarnation(status));
  board_.set_reachable(worker_id, task_readers_.contains(worker.participant));
  go_on();
}

void RemotePool::on_worker_gone(const messaging::SampleInfo& info) {
  const auto found = known_.find(info.instance);
  if (found == known_.end()) return;
  board_.worker_gone(found->second.worker_id);
  known_.erase(found);
  go_on();
}

void RemotePool::drop_silent_workers() {
  bool any = false;
  for (auto it = known_.begin(); it != known_.end();) {
    if (++it->second.silent_ticks <= kSilentTicks) {
      ++it;
      continue;
    }
    board_.worker_gone(it->second.worker_id);
    it = known_.erase(it);
    any = true;
  }
  if (any) go_on();
}

void RemotePool::exclude(const std::string& worker_id, const std::string& why) {
  if (board_.exclude(worker_id)) on_fault_("worker of another version", worker_id + ": " + why);
}

// A task to a worker whose reader is not connected yet would be lost, so the connections count.
void RemotePool::on_event(const messaging::Event& event) {
  if (event.topic != messaging::kMatchTask) return;
  const service::ParticipantId participant = service::participant_of(event.peer);
  if (event.kind == messaging::EventKind::kMatched) {
    task_readers_.insert(participant);
  } else if (event.kind == messaging::EventKind::kUnmatched) {
    task_readers_.erase(participant);
  } else {
    return;
  }
  for (const auto& [instance, worker] : known_) {
    if (worker.participant != participant) continue;
    board_.set_reachable(worker.worker_id, task_readers_.contains(participant));
  }
  go_on();
}

}  // namespace topogeo::localizer
