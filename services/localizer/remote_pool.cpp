#include "remote_pool.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "topogeo/matching/place_field.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::localizer {

using localization::MatchResult;
using localization::MatchTask;
using search_pool::BoardTime;
using search_pool::PoolLog;
using search_pool::Reception;
using search_pool::Recovery;
using search_pool::Refusal;
using search_pool::TaskBoard;
using search_pool::WorkerRegistry;

namespace {

/// Longest single wait for events, each of which wakes the pool at once.
constexpr std::chrono::seconds kLongestWait{1};

/// Workers publish their status every 500 ms; one that is silent for a second is gone. DDS
/// liveliness does not suffice: while any other worker lives, Fast DDS 2.9 reports a dead one as
/// alive until the lease of its participant ends (upstream report 4373). The pool counts ticks of
/// the loop, not time, so that no worker is lost because the loop stood still.
constexpr std::chrono::milliseconds kTick{125};
constexpr int kSilentTicks = 9;

BoardTime now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

PoolLog::Sink sink_or_log(PoolLog::Sink sink) {
  if (sink) return sink;
  return [](const std::string& line) { spdlog::info("{}", line); };
}

}  // namespace

RemotePool::RemotePool(const messaging::Participant& participant, messaging::EventLoop& loop,
                       RemotePoolOptions options, FaultHandler on_fault)
    : loop_(loop),
      options_(std::move(options)),
      on_fault_(std::move(on_fault)),
      matcher_fingerprint_(localization::matcher_fingerprint()),
      board_(options_.board),
      registry_({options_.version, matcher_fingerprint_, options_.config_fingerprint}),
      log_(sink_or_log(options_.log)),
      statuses_(participant),
      results_(participant, {{}, options_.client_id}),
      tasks_out_(participant),
      maps_(participant, loop, options_.client_id, on_fault_) {
  loop_.on_event([this](const messaging::Event& event) { on_event(event); });
  loop_.add<msg::WorkerStatus>(
      statuses_,
      [this](const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
        on_status(status, info);
      },
      [this](const messaging::SampleInfo& info) {
        if (const auto worker_id =
                registry_.gone(info.instance.bytes, service::participant_of(info.writer)))
          drop(*worker_id);
      });
  loop_.add<msg::MatchResults>(
      results_, [this](const msg::MatchResults& message, const messaging::SampleInfo& info) {
        on_results(message, info);
      });
  loop_.add(tasks_out_.writer());
  timer_ = loop_.add_timer(kTick, [this] { on_tick(); });
}

RemotePool::~RemotePool() {
  loop_.cancel_timer(timer_);
}

void RemotePool::add_map(std::shared_ptr<const topomap::LocalMap> map) {
  maps_.add(std::move(map));
}

void RemotePool::add_field(std::shared_ptr<const localization::PlaceField> field) {
  for (const auto& piece : field->pieces()) maps_.add(piece);
  matcher_.add_field(std::move(field));
}

// --- the wait

std::vector<MatchResult> RemotePool::match(std::span<const MatchTask> tasks) {
  // A whole map with more pieces than a message can name is searched here.
  if (!tasks.empty() && tasks.front().places &&
      tasks.front().places->pieces.size() > localization::PlaceField::kMostPieces) {
    std::vector<MatchResult> results;
    for (const MatchTask& task : tasks) results.push_back(matcher_.solve(task));
    return results;
  }
  board_.begin(tasks);
  try {
    work();
  } catch (...) {
    board_.abandon();
    throw;
  }
  return board_.take_results();
}

void RemotePool::work() {
  while (!board_.done()) {
    send_waiting();
    if (const std::optional<std::size_t> here = board_.next_local(now())) {
      log_.searching_here(board_.workers(), now());
      board_.solved(*here, solve(board_.task(*here)), now());
      log_recoveries();
      run_loop(std::chrono::nanoseconds::zero(), {});
      continue;
    }
    if (const std::optional<std::size_t> audit = board_.next_audit()) {
      settle(board_.task(*audit));
      run_loop(std::chrono::nanoseconds::zero(), {});
      continue;
    }
    const BoardTime time = now();
    const BoardTime due = board_.next_deadline(time).value_or(time + kLongestWait);
    run_loop(std::min<BoardTime>(due - time, kLongestWait),
             [this] { return board_.done() || board_.next_audit() || board_.next_local(now()); });
  }
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
    loop_.stop();  // ends the loop that calls this, too
    throw Stopped();
  }
}

void RemotePool::go_on() {
  send_waiting();
  log_recoveries();
  if (until_ && !woken_ && until_()) {
    woken_ = true;
    loop_.stop();
  }
}

void RemotePool::log_recoveries() {
  for (const Recovery& recovery : board_.take_recoveries()) log_.recovered(recovery);
}

// --- tasks out

void RemotePool::send_waiting() {
  while (true) {
    std::map<std::string, std::vector<TaskBoard::Assignment>> by_worker;
    while (std::optional<TaskBoard::Assignment> next = board_.next_remote(now())) {
      by_worker[next->worker_id].push_back(std::move(*next));
    }
    if (by_worker.empty()) return;
    for (const auto& [worker_id, all] : by_worker) {
      for (std::span rest(all); !rest.empty();) {
        const std::span<const TaskBoard::Assignment> part =
            rest.first(std::min<std::size_t>(rest.size(), msg::kMaxTasksInMessage));
        rest = rest.subspan(part.size());
        if (send(part)) continue;
        for (const TaskBoard::Assignment& assignment : part) board_.not_sent(assignment, now());
        on_fault_("task not sent", "the history of worker " + worker_id + " is full");
      }
    }
  }
}

bool RemotePool::send(std::span<const TaskBoard::Assignment> of_one_worker) {
  service::MatchAddress address;
  address.robot_id = options_.robot_id;
  address.sequence_number = sequence_++;
  address.worker_id = of_one_worker.front().worker_id;
  address.client_id = options_.client_id;
  address.version = options_.version;
  address.config_fingerprint = options_.config_fingerprint;
  address.matcher_fingerprint = matcher_fingerprint_;
  msg::MatchTasks message = service::tasks_for(address);
  for (const TaskBoard::Assignment& assignment : of_one_worker) {
    const MatchTask& task = board_.task(assignment.task);
    const topomap::LocalMap* query = maps_.find(task.query_map_id);
    if (query == nullptr) {
      throw std::out_of_range("match task " + std::to_string(task.task_id) + ": local map " +
                              std::to_string(task.query_map_id) + " is unknown");
    }
    const topomap::LocalMap* other = task.places ? query : maps_.find(task.reference_map_id);
    const std::int64_t newer_ns = std::max(query->stamp_ns, (other ? other : query)->stamp_ns);
    message.tasks().push_back(service::to_msg(task, newer_ns));
  }
  message.stamp_ns(message.tasks().front().stamp_ns());
  return tasks_out_.write(message, registry_.owner(address.worker_id));
}

// --- tasks solved here

void RemotePool::prepare(const MatchTask& task) {
  if (task.places) return;  // add_field did
  for (const auto& [id, hash] : {std::pair{task.reference_map_id, task.reference_hash},
                                 std::pair{task.query_map_id, task.query_hash}}) {
    const topomap::LocalMap* map = maps_.find(id);
    if (map != nullptr && !matcher_.has_map(id, hash)) matcher_.add_map(*map);
  }
}

MatchResult RemotePool::solve(const MatchTask& task) {
  prepare(task);
  return matcher_.solve(task);
}

std::string RemotePool::complaint(const MatchTask& task, const MatchResult& result) {
  if (!options_.verify) return {};
  try {
    prepare(task);
    return matcher_.verify(task, result);
  } catch (const std::exception& error) {
    return error.what();  // a task without any answer
  }
}

void RemotePool::settle(const MatchTask& task) {
  const MatchResult truth = solve(task);
  for (const TaskBoard::Difference& difference : board_.settle(truth, now())) {
    blame(task, difference, truth);
  }
  log_recoveries();
}

void RemotePool::blame(const MatchTask& task, const TaskBoard::Difference& difference,
                       const MatchResult& truth) {
  const char* reason = "different answers to a task";
  std::string what = complaint(task, difference.answer);
  if (!what.empty()) {
    reason = "wrong match result";
  } else {
    if (difference.answer.fitness < truth.fitness) reason = "poorer match result";
    what = fmt::format("valid answer with fitness {:.6f}; an own search found {:.6f}",
                       difference.answer.fitness, truth.fitness);
  }
  if (difference.unchecked > 0) {
    what += fmt::format("; {} earlier answers of this worker were accepted unchecked",
                        difference.unchecked);
  }
  on_fault_(reason, fmt::format("{}, task {}: {}", registry_.name(difference.worker_id),
                                task.task_id, what));
}

// --- answers in

void RemotePool::on_results(const msg::MatchResults& message, const messaging::SampleInfo& info) {
  const std::string worker_id = message.worker_id().to_string();
  // An answer counts only from the process that the task was sent to.
  const bool counts = registry_.is_owner(service::participant_of(info.writer), worker_id);
  for (const msg::MatchResult& result : message.results()) {
    if (counts) {
      on_result(worker_id, result);
    } else {
      board_.ignore_answer();
    }
  }
  if (counts) go_on();
}

void RemotePool::on_result(const std::string& worker_id, const msg::MatchResult& message) {
  const std::uint64_t task_id = message.task_id();
  switch (message.status()) {
    case msg::kMatchSolved:
    case msg::kMatchNothingInCommon:
      on_answer(worker_id, message);
      break;
    case msg::kMatchMapMissing:
      board_.refuse(worker_id, task_id, Refusal::kMapMissing, now());
      break;
    case msg::kMatchOtherVersion:
    case msg::kMatchOtherConfiguration:
      if (board_.exclude(worker_id, now())) {
        on_fault_(message.status() == msg::kMatchOtherVersion ? "worker of another version"
                                                              : "worker of another configuration",
                  registry_.name(worker_id) + ": " + message.message().to_string());
      }
      break;
    case msg::kMatchFailed:
      on_fault_("task failed", registry_.name(worker_id) + ": " + message.message().to_string());
      board_.refuse(worker_id, task_id, Refusal::kFailed, now());
      break;
    default:
      on_wrong(worker_id, task_id, "unknown status " + std::to_string(message.status()));
  }
}

void RemotePool::on_answer(const std::string& worker_id, const msg::MatchResult& message) {
  const std::uint64_t task_id = message.task_id();
  if (board_.is_excluded(worker_id)) {
    board_.ignore_answer();
    return;
  }
  MatchResult result;
  try {
    result = service::from_msg(message);
  } catch (const std::invalid_argument& error) {
    on_wrong(worker_id, task_id, error.what());
    return;
  }
  const MatchTask* task = board_.given(worker_id, task_id);
  if (task != nullptr && board_.is_open(task_id)) {
    const std::string what = complaint(*task, result);
    if (!what.empty()) {
      on_wrong(worker_id, task_id, what);
      return;
    }
  }
  switch (board_.answer(worker_id, std::move(result), now())) {
    case Reception::kFirst:
      log_.answered();
      break;
    case Reception::kDifferent:
      settle(*task);
      break;
    case Reception::kDuplicate:
    case Reception::kUnknown:
      break;
  }
}

void RemotePool::on_wrong(const std::string& worker_id, std::uint64_t task_id,
                          const std::string& what) {
  if (!board_.distrust(worker_id, now())) return;
  on_fault_("wrong match result",
            registry_.name(worker_id) + ", task " + std::to_string(task_id) + ": " + what);
}

// --- workers

void RemotePool::on_status(const msg::WorkerStatus& status, const messaging::SampleInfo& info) {
  const std::string robot_id = status.robot_id().to_string();
  if (!robot_id.empty() && robot_id != options_.robot_id) return;
  search_pool::WorkerReport report;
  report.worker_id = status.worker_id().to_string();
  report.host = status.host().to_string();
  report.build = {status.version().to_string(), status.matcher_fingerprint(),
                  status.config_fingerprint()};
  const service::ParticipantId from = service::participant_of(info.writer);
  const WorkerRegistry::Verdict verdict = registry_.update(report, from, info.instance.bytes);
  if (verdict.fault) on_fault_(verdict.fault->reason, verdict.fault->detail);
  if (!verdict.usable) return;
  board_.worker_up(report.worker_id, status.draining() ? 0 : status.slots(), now());
  board_.set_reachable(report.worker_id, tasks_out_.connected(from));
  go_on();
}

void RemotePool::drop(const std::string& worker_id) {
  board_.worker_gone(worker_id);
  go_on();
}

void RemotePool::on_tick() {
  for (const std::string& worker_id : registry_.tick(kSilentTicks)) drop(worker_id);
  log_.workers(board_.usable_workers(), now());
  maps_.tick();
}

void RemotePool::on_event(const messaging::Event& event) {
  if (const auto participant = tasks_out_.follow(event)) on_task_reader(*participant);
  if (event.topic != messaging::kMatchResults || event.kind != messaging::EventKind::kInvalidSample)
    return;
  // An answer that breaks the wire contract has no reliable task id.
  for (const std::string& worker_id : registry_.workers_of(service::participant_of(event.peer))) {
    if (!board_.distrust(worker_id, now())) continue;
    on_fault_("wrong match result", registry_.name(worker_id) + ": " + event.detail);
  }
  go_on();
}

void RemotePool::on_task_reader(const service::ParticipantId& participant) {
  for (const std::string& worker_id : registry_.workers_of(participant)) {
    board_.set_reachable(worker_id, tasks_out_.connected(participant));
  }
  go_on();
}

}  // namespace topogeo::localizer
