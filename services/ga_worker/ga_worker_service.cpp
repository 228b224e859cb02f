#include "ga_worker_service.hpp"

#include <algorithm>
#include <stdexcept>

#include <unistd.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::ga_worker {

namespace {

/// Localizers consider a worker lost after a second of silence: two statuses.
constexpr std::chrono::milliseconds kStatusPeriod{500};
/// The task rate is averaged over this window: steady, yet soon up to date.
constexpr std::chrono::seconds kRateWindow{5};
/// A client that does not connect or take its results for so long is gone.
constexpr double kClientPatience_s = 10.0;
/// Time for the last status to leave before the writer is deleted.
constexpr std::chrono::milliseconds kFarewell{200};
/// A slot with less memory would recompute the features of maps for nearly every task.
constexpr std::size_t kLeastPerSlot_bytes = std::size_t{4} << 20U;

/// One half of the memory holds the local maps, the other the features that slots compute of them.
std::size_t half_of_memory(const WorkerOptions& options) {
  return (std::size_t{options.memory_mb} << 20U) / 2;
}

/// Throws std::invalid_argument for a map that does not match its hash.
search_pool::MapPointer map_of(const msg::LocalMap& message) {
  topomap::LocalMap map = service::from_msg(message);
  map.track = {};  // matching does not use it
  return std::make_shared<const topomap::LocalMap>(std::move(map));
}

search_pool::IntakeOptions intake_options(const WorkerOptions& options) {
  search_pool::IntakeOptions intake;
  intake.map_bytes = half_of_memory(options);
  return intake;
}

}  // namespace

GaWorkerService::GaWorkerService(service::Service& service, const WorkerOptions& options)
    : service_(service),
      options_(options),
      statuses_(service.advertise<msg::WorkerStatus>()),
      requests_(service.advertise<msg::MapRequest>()),
      outcomes_([this] { service_.loop().post([this] { take_outcomes(); }); }),
      results_(service, options.worker_id, clients_, outcomes_, [this] { take_outcomes(); }),
      intake_(intake_options(options)),
      client_patience_(kClientPatience_s, 0.0) {
  messaging::EventLoop& loop = service_.loop();
  const std::size_t per_slot = half_of_memory(options_) / std::max(1U, options_.slots);
  runner_.emplace(
      options_.slots, std::max(per_slot, kLeastPerSlot_bytes), options_.scheduling,
      [this](search_pool::TaskRunner::Outcome outcome) { outcomes_.add(std::move(outcome)); });
  fill_status();
  listen();
  loop.add_timer(kStatusPeriod, [this] { publish_status(); });
  publish_status();
  service_.status().set_state(msg::kServiceRunning);
  const service::ServiceOptions& joined = service_.setup().options;
  spdlog::info("worker {} with {} {} joined domain {}, partition {}", options_.worker_id,
               options_.slots, options_.slots == 1 ? "slot" : "slots", joined.domain,
               joined.partition);
}

void GaWorkerService::fill_status() {
  messaging::set_header(status_, "", 0, 0);  // no robot: the worker serves any
  messaging::set_worker_id(status_, options_.worker_id);
  messaging::set_text(status_.name(), options_.name, "name");
  messaging::set_text_cut(status_.host(), support::host_name());
  messaging::set_text(status_.version(), support::kVersion, "version");
  status_.process_id(static_cast<std::uint32_t>(::getpid()));
  status_.slots(options_.slots);
  const service::Setup& setup = service_.setup();
  status_.config_fingerprint(setup.options.config ? setup.config.effective.fingerprint : 0);
  status_.matcher_fingerprint(localization::matcher_fingerprint());
}

void GaWorkerService::listen() {
  service_.loop().on_event([this](const messaging::Event& event) { on_event(event); });
  service_.subscribe<msg::LocalMap>(
      [this](const msg::LocalMap& map) { run(intake_.add_published(map_of(map))); },
      {.any_robot = true});
  service_.subscribe<msg::MapCopy>(
      [this](const msg::MapCopy& copy) {
        if (intake_.lacks(copy.local_map().content_hash())) {
          run(intake_.add_map(map_of(copy.local_map())));
        }
      },
      {.addressee = options_.worker_id, .any_robot = true});
  service_.subscribe<msg::MatchTasks>(
      [this](const msg::MatchTasks& tasks, const messaging::SampleInfo& info) {
        on_tasks(tasks, info);
      },
      {.addressee = options_.worker_id, .any_robot = true, .main_input = true});
}

// --- maps

void GaWorkerService::run(std::vector<search_pool::ReadyJob> jobs) {
  for (search_pool::ReadyJob& job : jobs) runner_->add(std::move(job));
}

void GaWorkerService::request_missing_maps() {
  if (request_timer_) service_.loop().cancel_timer(*request_timer_);
  request_timer_.reset();
  const Clock::time_point now = Clock::now();
  const search_pool::TaskIntake::Due due = intake_.check(now);
  for (const search_pool::TaskIntake::Request& wanted : due.requests) request(wanted);
  for (const search_pool::TaskIntake::GivenUp& given_up : due.given_up) {
    if (auto asked = asked_.extract(given_up.job.ticket)) {
      refuse(asked.mapped(), msg::kMatchMapMissing, given_up.why);
    }
  }
  if (const std::optional<Clock::time_point> next = intake_.next_check()) {
    request_timer_ = service_.loop().call_after(
        std::max<std::chrono::nanoseconds>(std::chrono::nanoseconds::zero(), *next - now),
        [this] { request_missing_maps(); });
  }
}

void GaWorkerService::request(const search_pool::TaskIntake::Request& request) {
  msg::MapRequest message;
  messaging::set_header(message, request.robot_id, request.stamp_ns, maps_requested_);
  messaging::set_client_id(message, request.client_id);
  messaging::set_worker_id(message, options_.worker_id);
  message.map_id(request.map_id);
  message.content_hash(request.content_hash);
  // The next period repeats a request that cannot be sent now.
  if (requests_.write(message)) ++maps_requested_;
}

// --- tasks

std::optional<std::pair<msg::MatchStatus, std::string>> GaWorkerService::objection(
    const msg::MatchTasks& message) const {
  const std::string version = message.version().to_string();
  if (version != support::kVersion ||
      message.matcher_fingerprint() != status_.matcher_fingerprint()) {
    return std::pair{msg::kMatchOtherVersion,
                     fmt::format("the client has version {} with matcher {:016x}, this worker "
                                 "version {} with matcher {:016x}",
                                 version, message.matcher_fingerprint(), support::kVersion,
                                 status_.matcher_fingerprint())};
  }
  if (status_.config_fingerprint() != 0 &&
      message.config_fingerprint() != status_.config_fingerprint()) {
    return std::pair{
        msg::kMatchOtherConfiguration,
        fmt::format("the client has configuration {:016x}, this worker was given {:016x}",
                    message.config_fingerprint(), status_.config_fingerprint())};
  }
  return {};
}

void GaWorkerService::on_tasks(const msg::MatchTasks& message, const messaging::SampleInfo& info) {
  if (message.worker_id().to_string() != options_.worker_id) return;
  const std::string robot_id = message.robot_id().to_string();
  const std::string client_id = message.client_id().to_string();
  const service::ParticipantId participant = service::participant_of(info.writer);
  if (clients_.task_came(client_id, robot_id, participant, Clock::now())) {
    spdlog::info("first task of client {}, robot {}", client_id, robot_id);
  }
  // All before the first answer, so that answers of refusal travel together, too.
  results_.expect(client_id, message.tasks().size());
  const auto refusal = objection(message);
  for (const msg::MatchTask& task : message.tasks()) {
    const Asked asked{client_id, task.stamp_ns(), task.task_id()};
    if (refusal) {
      refuse(asked, refusal->first, refusal->second);
    } else {
      take(task, asked, robot_id);
    }
  }
  if (intake_.waiting() > 0) request_missing_maps();
}

void GaWorkerService::take(const msg::MatchTask& message, const Asked& asked,
                           const std::string& robot_id) {
  search_pool::MatchJob job{next_ticket_, asked.client_id, robot_id, asked.stamp_ns, {}};
  try {
    job.task = service::from_msg(message);
  } catch (const std::invalid_argument& error) {
    refuse(asked, msg::kMatchFailed, error.what());
    return;
  }
  asked_.emplace(next_ticket_++, asked);
  if (std::optional<search_pool::ReadyJob> ready = intake_.add(std::move(job), Clock::now())) {
    runner_->add(std::move(*ready));
  }
}

void GaWorkerService::take_outcomes() {
  for (const search_pool::TaskRunner::Outcome& outcome : outcomes_.take()) on_outcome(outcome);
}

void GaWorkerService::on_outcome(const search_pool::TaskRunner::Outcome& outcome) {
  const auto asked = asked_.extract(outcome.ticket);
  if (!asked) return;  // its client is gone
  if (outcome.failed) {
    refuse(asked.mapped(), msg::kMatchFailed, outcome.message);
    return;
  }
  ++done_;
  answer(asked.mapped(), service::to_msg(outcome.result));
}

void GaWorkerService::refuse(const Asked& asked, msg::MatchStatus status, const std::string& why) {
  ++failures_;
  service_.status().fault("task refused", "task " + std::to_string(asked.task_id) + " of client " +
                                              asked.client_id + ": " + why);
  localization::MatchResult nothing;
  nothing.task_id = asked.task_id;
  msg::MatchResult result = service::to_msg(nothing);
  result.status(status);
  messaging::set_text_cut(result.message(), why);
  answer(asked, std::move(result));
}

void GaWorkerService::answer(const Asked& asked, msg::MatchResult result) {
  clients_.answered(asked.client_id);
  results_.add(asked.client_id, std::move(result), asked.stamp_ns);
}

// --- clients

void GaWorkerService::on_event(const messaging::Event& event) {
  if (event.topic != messaging::kMatchResults) return;
  const service::ParticipantId participant = service::participant_of(event.peer);
  if (event.kind == messaging::EventKind::kMatched) {
    clients_.reader_came(participant);
    results_.send_all();
  } else if (event.kind == messaging::EventKind::kUnmatched) {
    forget(clients_.reader_gone(participant));
  }
}

// Nobody waits for the remaining work of these clients.
void GaWorkerService::forget(const std::vector<search_pool::ClientRegistry::Entry>& gone) {
  for (const search_pool::ClientRegistry::Entry& entry : gone) {
    const std::string& client_id = entry.first;
    const search_pool::ClientRegistry::Client& client = entry.second;
    spdlog::info("client {}, robot {}, disconnected after {} answers", client_id, client.robot_id,
                 client.answered);
    runner_->remove(client_id);
    intake_.remove(client_id);
    // Includes tasks that a slot has begun or finished: a returning client asks anew.
    std::erase_if(asked_, [&](const auto& task) { return task.second.client_id == client_id; });
    results_.forget(client_id);
    // The writer has room for a limited number of instances, one per client.
    msg::MapRequest request;
    messaging::set_client_id(request, client_id);
    requests_.dispose(request);
  }
}

// --- status

void GaWorkerService::measure_load(Clock::time_point time) {
  const std::chrono::nanoseconds busy = runner_->busy_time();
  const double available_s =
      std::chrono::duration<double>(time - last_status_).count() * options_.slots;
  const double busy_s = std::chrono::duration<double>(busy - busy_at_last_status_).count();
  status_.load(available_s > 0.0 ? std::clamp(busy_s / available_s, 0.0, 1.0) : 0.0);
  busy_at_last_status_ = busy;
  last_status_ = time;
  done_history_.emplace_back(time, done_);
  while (time - done_history_.front().first > kRateWindow) done_history_.pop_front();
  const double window_s = std::chrono::duration<double>(time - done_history_.front().first).count();
  const double done_in_window = static_cast<double>(done_ - done_history_.front().second);
  status_.tasks_per_s(window_s > 0.0 ? done_in_window / window_s : 0.0);
}

void GaWorkerService::drop_overdue(Clock::time_point time) {
  const bool busy = service_.cpu().lasts();
  const std::optional<double> before_s =
      client_patience_.over_before(std::chrono::duration<double>(time - start_).count(),
                                   busy ? support::PatienceClock::kBusyRate : 1.0);
  if (!before_s) return;
  const Clock::time_point before = start_ + std::chrono::duration_cast<Clock::duration>(
                                                std::chrono::duration<double>(*before_s));
  results_.drop_older(before);
  forget(clients_.take_silent(before));
}

void GaWorkerService::publish_status() {
  const Clock::time_point time = Clock::now();
  results_.send_all();
  drop_overdue(time);
  measure_load(time);
  status_.stamp_ns(support::wall_clock_ns());
  status_.uptime_s(std::chrono::duration<double>(time - start_).count());
  status_.tasks_in_hand(static_cast<std::uint32_t>(asked_.size()));
  status_.tasks_done(done_);
  status_.failures(failures_);
  status_.maps_held(static_cast<std::uint32_t>(intake_.maps().size()));
  status_.clients(static_cast<std::uint32_t>(clients_.active(time - kRateWindow)));
  // The next period repeats a status that cannot be sent now.
  if (statuses_.write(status_)) status_.sequence_number(status_.sequence_number() + 1);
  messaging::StatusPublisher& service_status = service_.status();
  const auto set = [&](const char* name, std::uint64_t value) {
    service_status.set_counter(name, static_cast<double>(value));
  };
  service_status.set_queue("tasks in hand", asked_.size());
  service_status.set_queue("tasks without maps", intake_.waiting());
  service_status.set_queue("answers to send", results_.waiting());
  service_status.set_counter("busy_slots", status_.load() * status_.slots());
  set("slots", status_.slots());
  set("tasks_done", done_);
  set("failures", failures_);
  set("clients", status_.clients());
  set("maps_held", intake_.maps().size());
  set("maps_dropped", intake_.maps().dropped());
  set("maps_requested", maps_requested_);
}

void GaWorkerService::drain() {
  status_.slots(0);
  status_.draining(true);
  publish_status();
  static_cast<void>(statuses_.wait_for_acknowledgments(kFarewell));
  constexpr std::chrono::milliseconds kLook{5};
  const auto open = [this] { return asked_.size() + results_.waiting(); };
  search_pool::DrainWatch watch(support::monotonic_s());
  while (!service_.loop().run_for(kLook)) {  // a second signal ends the loop at once
    if (!watch.goes_on(support::monotonic_s(), open(), service_.cpu().lasts())) break;
  }
  results_.wait_for_acknowledgments(kFarewell);
  statuses_.dispose(status_);
  const std::string busy = service_.cpu().lasts() ? "; " + service_.cpu().text() : "";
  spdlog::info("worker {} left after {:.1f} s: {} tasks done for {} clients, {} failures{}",
               options_.worker_id, std::chrono::duration<double>(Clock::now() - start_).count(),
               done_, clients_.ever(), failures_,
               open() == 0 ? "" : fmt::format(", {} not finished{}", open(), busy));
}

}  // namespace topogeo::ga_worker
