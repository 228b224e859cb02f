// Peers and events of a writer or reader: threads of the middleware fill them, the program's thread
// empties them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <set>

#include <fastdds/dds/core/status/IncompatibleQosStatus.hpp>

#include "topogeo/messaging/detail/endpoint.hpp"
#include "topogeo/messaging/detail/fast_dds.hpp"

namespace topogeo::messaging::detail {

struct Endpoint::Shared {
  /// Events beyond this number are dropped, oldest first.
  static constexpr std::size_t kMaxEvents = 10'000;

  explicit Shared(std::string_view topic_name) : topic(topic_name) {}

  void push(Event event);
  /// Counts peers and appends the event.
  void set_matched(int current, int change, const rtps::InstanceHandle_t& peer);
  /// Wakes the program's loop, if it has one.
  void wake_program();
  void push_incompatible(const eprosima::fastdds::dds::IncompatibleQosStatus& status);

  const std::string topic;
  std::atomic<std::uint64_t> messages = 0;
  mutable std::mutex mutex;
  mutable std::condition_variable matched_changed;
  int matched = 0;
  std::set<Handle> peers;
  std::deque<Event> events;
  std::function<void()> wake;
};

Handle to_handle(const rtps::InstanceHandle_t& handle);

/// The role's name: `role` if not empty, else that of the topic.
std::string profile_name(const TopicInfo& topic, const std::string& role, const char* side);

}  // namespace topogeo::messaging::detail
