#include "topogeo/messaging/status_publisher.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::messaging {

namespace {

// Tables and the search pool take a program for silent after 1.5 s: three statuses lost.
constexpr std::chrono::milliseconds kPeriod{500};
// Of a fault that repeats itself: a log stays readable.
constexpr std::chrono::seconds kLogPeriod{1};
// For the last status to leave before the writer is deleted.
constexpr std::chrono::milliseconds kFarewell{200};
// Stands for the faults of all further reasons, once the status has no room for another one.
constexpr std::string_view kOtherFaults = "other";
constexpr std::size_t kMaxNameSize = 48;  // status.idl

/// Topics where only the last sample of an instance counts: one that was lost has been replaced by
/// a newer one before it could be sent.
bool is_replaceable(const std::string& name) {
  const auto topics = all_topics();
  return std::any_of(topics.begin(), topics.end(), [&](const TopicInfo* topic) {
    return topic->name == name && (topic->role == "state" || topic->role == "status");
  });
}

}  // namespace

StatusPublisher::StatusPublisher(const Participant& participant, EventLoop& loop,
                                 const ServiceIdentity& identity)
    : loop_(loop), writer_(participant), start_(std::chrono::steady_clock::now()) {
  const std::string host = support::host_name();
  const std::string instance = identity.instance.empty()
                                   ? host.substr(0, 48) + "-" + std::to_string(::getpid())
                                   : identity.instance;
  set_header(status_, identity.robot_id, 0, 0);
  set_service(status_, identity.service, instance);
  set_text(status_.version(), identity.version, "version");
  set_text(status_.host(), host, "host");
  status_.process_id(static_cast<std::uint32_t>(::getpid()));
  status_.started_ns(support::wall_clock_ns());
  status_.state(msg::kServiceStarting);
  loop_.add(writer_);
  loop_.on_event([this](const Event& event) { on_event(event); });
  timer_ = loop_.add_timer(kPeriod, [this] { publish(); });
  publish();
}

StatusPublisher::~StatusPublisher() {
  loop_.cancel_timer(timer_);
  try {
    if (state() != msg::kServiceFailed && state() != msg::kServiceFinished) {
      status_.state(msg::kServiceStopped);
    }
    publish();
    static_cast<void>(writer_.wait_for_acknowledgments(kFarewell));
  } catch (const std::exception& error) {
    spdlog::warn("last status not sent: {}", error.what());
  }
}

void StatusPublisher::set_state(msg::ServiceState state, std::string_view message) {
  status_.state(state);
  set_text_cut(status_.message(), message);
  spdlog::debug("{}", text());
  publish();
}

std::string StatusPublisher::text() const {
  constexpr std::array<const char*, 6> kNames = {"starting", "waiting", "running",
                                                 "finished", "failed",  "stopped"};
  const std::string message = status_.message().c_str();
  return kNames.at(status_.state()) + (message.empty() ? "" : ": " + message);
}

void StatusPublisher::count_input(std::string_view name) {
  if (input_.total() == 0) set_text_cut(status_.input(), name);
  input_.count(std::chrono::steady_clock::now());
}

void StatusPublisher::set_counter(const std::string& name, double value) {
  if (name.size() > kMaxNameSize) {
    throw std::invalid_argument("counter '" + name + "': longer than " +
                                std::to_string(kMaxNameSize) + " bytes");
  }
  if (!counters_.contains(name) && counters_.size() == msg::kMaxCounters) {
    throw std::length_error("counter '" + name + "': more than " +
                            std::to_string(msg::kMaxCounters) + " counters");
  }
  counters_[name] = value;
}

void StatusPublisher::add_to_counter(const std::string& name, double amount) {
  const auto found = counters_.find(name);
  set_counter(name, (found == counters_.end() ? 0.0 : found->second) + amount);
}

void StatusPublisher::fault(std::string_view reason, std::string_view detail) {
  const bool known = faults_.contains(reason);
  const bool room = faults_.size() + 1 < msg::kMaxFaultKinds && reason.size() <= kMaxNameSize;
  Fault& fault = faults_[std::string(known || room ? reason : kOtherFaults)];
  const auto now = std::chrono::steady_clock::now();
  ++fault.count;
  status_.fault_count(status_.fault_count() + 1);
  set_text_cut(status_.message(), std::string(reason) + ": " + std::string(detail));
  if (fault.count > 1 && now - fault.last_log < kLogPeriod) {
    ++fault.not_logged;
    return;
  }
  if (fault.not_logged > 0) {
    spdlog::warn("{}: {} ({} more since the last message)", reason, detail, fault.not_logged);
  } else {
    spdlog::warn("{}: {}", reason, detail);
  }
  fault.last_log = now;
  fault.not_logged = 0;
}

void StatusPublisher::on_event(const Event& event) {
  switch (event.kind) {
    case EventKind::kSampleLost:
      if (is_replaceable(event.topic)) return;
      [[fallthrough]];
    case EventKind::kIncompatibleQos:
    case EventKind::kInvalidSample:
    case EventKind::kDeadlineMissed:
      fault(to_string(event.kind), event.topic + (event.detail.empty() ? "" : ": ") + event.detail);
      return;
    case EventKind::kMatched:
    case EventKind::kUnmatched:
    case EventKind::kLivelinessGained:
    case EventKind::kLivelinessLost:
    case EventKind::kSampleRejected:  // how a slow reader slows a replay
      return;
  }
}

void StatusPublisher::publish() {
  const auto now = std::chrono::steady_clock::now();
  status_.stamp_ns(support::wall_clock_ns());
  status_.uptime_s(std::chrono::duration<double>(now - start_).count());
  status_.inputs(input_.total());
  status_.input_rate_per_s(input_.rate_per_s(now));
  status_.input_age_s(input_.age_s(now));
  status_.counters().clear();
  for (const auto& [name, value] : counters_) {
    msg::Counter counter;
    set_text(counter.name(), name, "counter");
    counter.value(value);
    status_.counters().push_back(counter);
  }
  status_.faults().clear();
  for (const auto& [reason, fault] : faults_) {
    msg::FaultCount count;
    set_text(count.reason(), reason, "fault");
    count.count(fault.count);
    status_.faults().push_back(count);
  }
  // The next period sends again what could not be sent now.
  if (writer_.write(status_)) status_.sequence_number(status_.sequence_number() + 1);
}

}  // namespace topogeo::messaging
