#include "topogeo/messaging/detail/endpoint.hpp"

#include <algorithm>
#include <utility>

#include <fastdds/dds/core/policy/QosPolicies.hpp>

#include "topogeo/messaging/same_participant.hpp"

#include "endpoint_shared.hpp"

namespace topogeo::messaging {

const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::kMatched:
      return "matched";
    case EventKind::kUnmatched:
      return "unmatched";
    case EventKind::kIncompatibleQos:
      return "incompatible_qos";
    case EventKind::kDeadlineMissed:
      return "deadline_missed";
    case EventKind::kSampleLost:
      return "sample_lost";
    case EventKind::kSampleRejected:
      return "sample_rejected";
    case EventKind::kInvalidSample:
      return "invalid_sample";
  }
  return "unknown";
}

namespace detail {

namespace dds = eprosima::fastdds::dds;

namespace {

const char* policy_name(dds::QosPolicyId_t policy) {
  switch (policy) {
    case dds::RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    case dds::DURABILITY_QOS_POLICY_ID:
      return "durability";
    case dds::LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case dds::DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case dds::OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case dds::PARTITION_QOS_POLICY_ID:
      return "partition";
    default:
      return "another policy";
  }
}

}  // namespace

Handle to_handle(const rtps::InstanceHandle_t& handle) {
  Handle result;
  for (std::size_t i = 0; i < result.bytes.size(); ++i) result.bytes[i] = handle.value[i];
  return result;
}

std::string profile_name(const TopicInfo& topic, const std::string& role, const char* side) {
  return (role.empty() ? std::string(topic.role) : role) + "_" + side;
}

void Endpoint::Shared::push(Event event) {
  event.topic = topic;
  // Wakes under the lock: once set_wake({}) has returned, no thread is about to wake an ending
  // loop.
  const std::lock_guard lock(mutex);
  if (events.size() == kMaxEvents) events.pop_front();
  events.push_back(std::move(event));
  if (wake) wake();
}

void Endpoint::Shared::wake_program() {
  const std::lock_guard lock(mutex);
  if (wake) wake();
}

void Endpoint::Shared::set_matched(int current, int change, const rtps::InstanceHandle_t& peer) {
  Event event;
  event.kind = change >= 0 ? EventKind::kMatched : EventKind::kUnmatched;
  event.peer = to_handle(peer);
  {
    const std::lock_guard lock(mutex);
    matched = current;
    if (change >= 0) {
      peers.insert(event.peer);
    } else {
      peers.erase(event.peer);
    }
  }
  matched_changed.notify_all();
  event.count = current;
  push(std::move(event));
}

void Endpoint::Shared::push_incompatible(const dds::IncompatibleQosStatus& status) {
  Event event;
  event.kind = EventKind::kIncompatibleQos;
  event.count = static_cast<int>(status.total_count);
  event.detail = std::string("a peer of topic ") + topic + " differs in " +
                 policy_name(status.last_policy_id) + " and cannot be connected";
  push(std::move(event));
}

Endpoint::Endpoint() = default;
Endpoint::~Endpoint() = default;

int Endpoint::matched() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->matched;
}

std::vector<Handle> Endpoint::peers() const {
  const std::lock_guard lock(shared_->mutex);
  return {shared_->peers.begin(), shared_->peers.end()};
}

bool Endpoint::connected_with(const Handle& program) const {
  const std::lock_guard lock(shared_->mutex);
  return std::ranges::any_of(shared_->peers,
                             [&](const Handle& peer) { return same_participant(peer, program); });
}

std::string_view Endpoint::topic() const {
  return shared_->topic;
}

std::uint64_t Endpoint::messages() const {
  return shared_->messages;
}

bool Endpoint::wait_for_matched(int count, std::chrono::nanoseconds timeout) const {
  std::unique_lock lock(shared_->mutex);
  return shared_->matched_changed.wait_for(lock, timeout,
                                           [&] { return shared_->matched >= count; });
}

void Endpoint::take_events(const EventHandler& handler) {
  std::deque<Event> events;
  {
    const std::lock_guard lock(shared_->mutex);
    events.swap(shared_->events);
  }
  for (const Event& event : events) handler(event);
}

void Endpoint::set_wake(std::function<void()> wake) {
  const std::lock_guard lock(shared_->mutex);
  shared_->wake = std::move(wake);
}

}  // namespace detail
}  // namespace topogeo::messaging
