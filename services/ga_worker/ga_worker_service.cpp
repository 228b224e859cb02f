#include "ga_worker_service.hpp"

#include <array>
#include <stdexcept>

#include <spdlog/spdlog.h>
#include <unistd.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::ga_worker {

namespace {

constexpr std::chrono::milliseconds kStatusPeriod{500};
constexpr std::chrono::seconds kRateWindow{5};
/// Local maps travel on another topic than the tasks that name them.
constexpr std::chrono::seconds kMapPatience{2};
/// A client that has not connected by then is gone.
constexpr std::chrono::seconds kClientPatience{10};
constexpr std::chrono::seconds kDrainPatience{10};
constexpr std::chrono::milliseconds kFarewell{200};
constexpr std::size_t kLongestWorkerId = 64;  // match.idl

std::string host_name() {
  std::array<char, 48> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

WorkerOptions checked(WorkerOptions options) {
  if (options.worker_id.empty()) {
    options.worker_id = host_name() + "-" + std::to_string(::getpid());
  }
  if (options.worker_id.size() > kLongestWorkerId ||
      options.worker_id.find_first_of("'\"%") != std::string::npos) {
    throw std::invalid_argument("worker id '" + options.worker_id +
                                "': expected at most 64 bytes without quotes and percent signs");
  }
  return options;
}

std::int64_t wall_clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

GaWorkerService::GaWorkerService(service::Service& service, const WorkerOptions& options)
    : service_(service),
      options_(checked(options)),
      statuses_(service.participant()),
      results_(service.participant()),
      maps_(service.participant()),
      tasks_(service.participant(), {{}, {"worker_id = %0", {"'" + options_.worker_id + "'"}}}),
      last_status_(Clock::now()) {
  messaging::EventLoop& loop = service_.loop();
  runner_.emplace(options_.slots, kMapPatience, [this, &loop](TaskRunner::Outcome outcome) {
    loop.post([this, outcome = std::move(outcome)] { on_outcome(outcome); });
  });
  messaging::set_header(status_, "", 0, 0);  // of no robot: it works for any
  messaging::set_text(status_.worker_id(), options_.worker_id, "worker_id");
  messaging::set_text_cut(status_.host(), host_name());
  messaging::set_text(status_.version(), support::kVersion, "version");
  status_.process_id(static_cast<std::uint32_t>(::getpid()));
  status_.slots(options_.slots);
  loop.on_event([this](const messaging::Event& event) { on_event(event); });
  loop.add<msg::LocalMap>(maps_, [this](const msg::LocalMap& message,
                                        const messaging::SampleInfo&) { on_map(message); });
  loop.add<msg::MatchTask>(
      tasks_, [this](const msg::MatchTask& message, const messaging::SampleInfo& info) {
        on_task(message, info);
      });
  loop.add(results_);
  loop.add(statuses_);
  loop.add_timer(kStatusPeriod, [this] { publish_status(); });
  publish_status();
  service_.status().set_state(msg::kServiceRunning);
  spdlog::info("worker {} with {} slots", options_.worker_id, options_.slots);
}

void GaWorkerService::on_map(const msg::LocalMap& message) {
  try {
    runner_->add_map(std::make_shared<const topomap::LocalMap>(service::from_msg(message)));
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid local map", error.what());
  }
}

void GaWorkerService::on_task(const msg::MatchTask& message, const messaging::SampleInfo& info) {
  if (message.worker_id().to_string() != options_.worker_id) return;
  Client client;
  client.address.robot_id = message.robot_id().to_string();
  client.address.stamp_ns = message.stamp_ns();
  client.address.worker_id = options_.worker_id;
  client.address.client_id = message.client_id().to_string();
  client.task_id = message.task_id();
  client.participant = service::participant_of(info.writer);
  const std::string version = message.version().to_string();
  if (version != support::kVersion) {
    refuse(client, msg::kMatchOtherVersion,
           "client has version " + version + ", this worker " + std::string(support::kVersion));
    return;
  }
  try {
    TaskRunner::Job job{next_ticket_, client.address.robot_id, service::from_msg(message)};
    clients_.emplace(next_ticket_++, std::move(client));
    runner_->add(std::move(job));
  } catch (const std::invalid_argument& error) {
    refuse(client, msg::kMatchFailed, error.what());
  }
}

void GaWorkerService::on_outcome(const TaskRunner::Outcome& outcome) {
  const auto found = clients_.find(outcome.ticket);
  if (found == clients_.end()) return;
  const Client client = std::move(found->second);
  clients_.erase(found);
  switch (outcome.failure) {
    case TaskRunner::Failure::kNone:
      ++done_;
      answer(service::to_msg(outcome.result, client.address), client);
      break;
    case TaskRunner::Failure::kMapMissing:
      refuse(client, msg::kMatchMapMissing, outcome.message);
      break;
    case TaskRunner::Failure::kFailed:
      refuse(client, msg::kMatchFailed, outcome.message);
      break;
  }
}

void GaWorkerService::refuse(const Client& client, msg::MatchStatus status,
                             const std::string& why) {
  ++failures_;
  service_.status().fault("task refused", "task " + std::to_string(client.task_id) + " of " +
                                              client.address.client_id + ": " + why);
  localization::MatchResult nothing;
  nothing.task_id = client.task_id;
  msg::MatchResult result = service::to_msg(nothing, client.address);
  result.status(status);
  messaging::set_text_cut(result.message(), why);
  answer(std::move(result), client);
}

void GaWorkerService::answer(msg::MatchResult result, const Client& client) {
  if (connected_.contains(client.participant)) {
    send(result);
  } else {
    unsent_.push_back({std::move(result), client.participant, Clock::now()});
  }
}

void GaWorkerService::send(const msg::MatchResult& result) {
  msg::MatchResult numbered = result;
  numbered.sequence_number(sequence_++);
  static_cast<void>(service_.send(results_, numbered, "match result"));
}

// A result to a client whose reader is not connected yet would be lost: it waits.
void GaWorkerService::on_event(const messaging::Event& event) {
  if (event.topic != messaging::kMatchResult) return;
  const service::ParticipantId participant = service::participant_of(event.peer);
  if (event.kind == messaging::EventKind::kUnmatched) {
    connected_.erase(participant);
  } else if (event.kind == messaging::EventKind::kMatched) {
    connected_.insert(participant);
    for (const Unsent& unsent : unsent_) {
      if (unsent.participant == participant) send(unsent.result);
    }
    std::erase_if(unsent_, [&](const Unsent& u) { return u.participant == participant; });
  }
}

void GaWorkerService::publish_status() {
  const Clock::time_point time = Clock::now();
  std::erase_if(unsent_, [&](const Unsent& u) { return time - u.since > kClientPatience; });
  const std::chrono::nanoseconds busy = runner_->busy_time();
  const double available_s =
      std::chrono::duration<double>(time - last_status_).count() * options_.slots;
  const double busy_s = std::chrono::duration<double>(busy - busy_at_last_status_).count();
  status_.load(available_s > 0.0 ? std::min(1.0, busy_s / available_s) : 0.0);
  busy_at_last_status_ = busy;
  last_status_ = time;
  done_history_.emplace_back(time, done_);
  while (time - done_history_.front().first > kRateWindow) done_history_.pop_front();
  const double window_s = std::chrono::duration<double>(time - done_history_.front().first).count();
  const double done_in_window = static_cast<double>(done_ - done_history_.front().second);
  status_.tasks_per_s(window_s > 0.0 ? done_in_window / window_s : 0.0);
  status_.stamp_ns(wall_clock_ns());
  status_.tasks_in_hand(static_cast<std::uint32_t>(runner_->in_hand()));
  status_.tasks_done(done_);
  status_.failures(failures_);
  status_.maps_held(static_cast<std::uint32_t>(runner_->maps_held()));
  // The next period sends again what could not be sent now.
  if (statuses_.write(status_)) status_.sequence_number(status_.sequence_number() + 1);
  messaging::StatusPublisher& service_status = service_.status();
  service_status.set_counter("slots", status_.slots());
  service_status.set_counter("tasks_done", static_cast<double>(done_));
  service_status.set_counter("failures", static_cast<double>(failures_));
  service_status.set_counter("maps_held", status_.maps_held());
}

void GaWorkerService::drain() {
  status_.slots(0);
  publish_status();
  static_cast<void>(statuses_.wait_for_acknowledgments(kFarewell));
  const Clock::time_point end = Clock::now() + kDrainPatience;
  constexpr std::chrono::milliseconds kLook{5};
  // At least once: outcomes and tasks that are here already.
  while (!service_.loop().run_for(kLook) && !clients_.empty() && Clock::now() < end) {
  }
  static_cast<void>(results_.wait_for_acknowledgments(kFarewell));
  statuses_.dispose(status_);
}

}  // namespace topogeo::ga_worker
