#include "topogeo/messaging/status_publisher.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include <unistd.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/strangers.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::messaging {

namespace {

// Tables and the search pool declare a program silent after 1.5 s, or three lost statuses.
constexpr std::chrono::milliseconds kPeriod{500};
// Limits the log lines of a repeated fault.
constexpr std::chrono::seconds kLogPeriod{1};
// Lets the last status leave before the writer is deleted.
constexpr std::chrono::milliseconds kFarewell{200};
// Collects the faults of further reasons once the status has no room for them.
constexpr std::string_view kOtherFaults = "other";
constexpr std::size_t kMaxNameSize = 48;  // status.idl
constexpr std::string_view kForgedRemovals = "forged_removal";

/// Topics where only the last sample of an instance counts: a newer sample replaced a lost one
/// before it could be sent.
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
  set_header(status_, identity.robot_id, 0, 0);
  set_service(status_, identity.service,
              identity.instance.empty() ? support::process_name() : identity.instance);
  set_text(status_.version(), identity.version, "version");
  set_text(status_.host(), support::host_name(), "host");
  status_.process_id(static_cast<std::uint32_t>(::getpid()));
  status_.started_ns(support::wall_clock_ns());
  status_.config_fingerprint(identity.config_fingerprint);
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
  status_.waits_for() = "";
  set_text_cut(status_.message(), message);
  if (state == msg::kServiceFailed) note_error(message);
  spdlog::debug("{}", text());
  publish();
}

void StatusPublisher::wait_for(std::string_view what) {
  status_.state(msg::kServiceWaiting);
  set_text_cut(status_.waits_for(), what);
  set_text_cut(status_.message(), "for " + std::string(what));
  spdlog::debug("{}", text());
  publish();
}

void StatusPublisher::set_waits_for(std::string_view what) {
  set_text_cut(status_.waits_for(), what);
}

std::string StatusPublisher::text() const {
  constexpr std::array<const char*, 6> kNames = {"starting", "waiting", "running",
                                                 "finished", "failed",  "stopped"};
  const std::string message = status_.message().c_str();
  return kNames.at(status_.state()) + (message.empty() ? "" : ": " + message);
}

void StatusPublisher::set_input(std::string_view name) {
  set_text_cut(status_.input(), name);
}

void StatusPublisher::count_input(std::string_view name) {
  if (input_.total() == 0) set_input(name);
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

void StatusPublisher::add_drops(std::string_view reason, std::uint64_t amount) {
  drops_of(reason) += amount;
}

void StatusPublisher::set_drops(std::string_view reason, std::uint64_t total) {
  if (total > 0) drops_of(reason) = total;
}

std::uint64_t& StatusPublisher::drops_of(std::string_view reason) {
  const bool room = drops_.size() + 1 < msg::kMaxDropKinds && reason.size() <= kMaxNameSize;
  return drops_[std::string(drops_.contains(reason) || room ? reason : kOtherFaults)];
}

void StatusPublisher::set_queue(const std::string& name, std::uint64_t depth,
                                std::uint64_t capacity) {
  if (name.size() > kMaxNameSize) {
    throw std::invalid_argument("queue '" + name + "': longer than " +
                                std::to_string(kMaxNameSize) + " bytes");
  }
  if (!queues_.contains(name) && queues_.size() == msg::kMaxQueues) {
    throw std::length_error("queue '" + name + "': more than " + std::to_string(msg::kMaxQueues) +
                            " queues");
  }
  queues_[name] = {depth, capacity};
}

void StatusPublisher::note_error(std::string_view text) {
  set_text_cut(status_.last_error(), text);
  last_error_ = std::chrono::steady_clock::now();
}

void StatusPublisher::fault(std::string_view reason, std::string_view detail) {
  const bool known = faults_.contains(reason);
  const bool room = faults_.size() + 1 < msg::kMaxFaultKinds && reason.size() <= kMaxNameSize;
  Fault& fault = faults_[std::string(known || room ? reason : kOtherFaults)];
  const auto now = std::chrono::steady_clock::now();
  ++fault.count;
  status_.fault_count(status_.fault_count() + 1);
  note_error(std::string(reason) + ": " + std::string(detail));
  if (fault.count > 1 && now - fault.last_log < kLogPeriod) {
    ++fault.not_logged;
    spdlog::debug("{}: {}", reason, detail);  // debug logs show every fault
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
    case EventKind::kInvalidSample:
      add_drops(to_string(event.kind));
      [[fallthrough]];
    case EventKind::kIncompatibleQos:
    case EventKind::kDeadlineMissed:
      fault(to_string(event.kind), event.topic + (event.detail.empty() ? "" : ": ") + event.detail);
      return;
    case EventKind::kMatched:
    case EventKind::kUnmatched:
    case EventKind::kSampleRejected:  // normal in a replay with a slow reader
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
  status_.last_error_age_s(status_.last_error().size() == 0
                               ? 0.0
                               : std::chrono::duration<double>(now - last_error_).count());
  fill_counts();
  fill_traffic(now);
  if (on_publish_) on_publish_(status_);
  // A status that could not be sent now goes out with the next period.
  if (writer_.write(status_)) status_.sequence_number(status_.sequence_number() + 1);
}

void StatusPublisher::on_publish(std::function<void(const msg::ServiceStatus&)> handler) {
  on_publish_ = std::move(handler);
}

void StatusPublisher::fill_counts() {
  const StrangerCounts strangers = stranger_counts();
  set_drops("invalid_packet", strangers.invalid_packets);
  set_drops("unprotected_packet", strangers.unprotected_packets);
  set_drops("security_error", strangers.security_errors);
  set_drops("denied_sample", strangers.denied_samples);
  set_drops("unknown_topic", strangers.unknown_topics);
  const auto forged = drops_.find(kForgedRemovals);
  if (strangers.forged_removals > (forged == drops_.end() ? 0 : forged->second)) {
    fault("forged removal", "a stranger reported the departure of a peer in its name");
  }
  set_drops(kForgedRemovals, strangers.forged_removals);
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
  status_.drops().clear();
  for (const auto& [reason, total] : drops_) {
    msg::FaultCount count;
    set_text(count.reason(), reason, "drop");
    count.count(total);
    status_.drops().push_back(count);
  }
  status_.queues().clear();
  for (const auto& [name, queue] : queues_) {
    msg::QueueDepth depth;
    set_text(depth.name(), name, "queue");
    depth.depth(queue.depth);
    depth.capacity(queue.capacity);
    status_.queues().push_back(depth);
  }
}

void StatusPublisher::fill_traffic(Time now) {
  std::map<std::pair<std::string_view, bool>, Traffic> sums;
  for (const Traffic& one : loop_.traffic()) {
    Traffic& sum = sums[{one.topic.substr(one.topic.rfind('/') + 1), one.sent}];
    sum.messages += one.messages;
    sum.waiting += one.waiting;
  }
  status_.traffic().clear();
  for (const auto& [key, sum] : sums) {
    if (status_.traffic().size() == msg::kMaxTrafficTopics) return;
    msg::TopicTraffic traffic;
    set_text(traffic.topic(), key.first, "topic");
    traffic.sent(key.second);
    traffic.messages(sum.messages);
    traffic.rate_per_s(rates_[key].add(now, sum.messages));
    traffic.waiting(sum.waiting);
    status_.traffic().push_back(traffic);
  }
}

}  // namespace topogeo::messaging
