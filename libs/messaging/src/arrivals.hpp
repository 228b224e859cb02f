// Samples that have arrived at a keep-last reader, until the program takes them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "topogeo/messaging/events.hpp"

namespace topogeo::messaging::detail {

struct Arrival {
  SampleInfo info;
  std::uint64_t number = 0;            ///< sequence number of its writer
  std::shared_ptr<void> message = {};  ///< null for a disposal, which has no content
};

/// Keeps the newest `depth` samples of each instance and writer. The history of the middleware
/// keeps that many of each instance over all writers: there a stranger's sample can displace a
/// peer's unread one, which is never sent again because it was acknowledged.
///
/// Serves one thread that takes and any number that put.
class Arrivals {
 public:
  /// `capacity`: number of samples over all instances and writers beyond which is_full().
  Arrivals(std::size_t depth, std::size_t capacity) : depth_(depth), capacity_(capacity) {}

  /// The middleware has samples that were not put here yet.
  void announce();
  /// Whether announce() was called or is_full() was true since the last call.
  bool take_announced();

  /// Adds samples; those of one writer may come in any order within a batch.
  void put(std::vector<Arrival> batch);

  /// Takes the sample that has waited longest; samples of a writer come in the order of their
  /// numbers.
  bool take(Arrival& oldest);

  /// True when `more` samples do not fit. They stay in the middleware until some here are taken.
  [[nodiscard]] bool is_full(std::size_t more);

  [[nodiscard]] std::size_t size() const;
  /// True as soon as a sample waits or is announced, false after `timeout`.
  bool wait(std::chrono::nanoseconds timeout);

 private:
  using Queue = std::list<Arrival>;
  using Key = std::pair<Handle, Handle>;  // instance, writer

  void put(Arrival arrival, Queue& replaced);

  const std::size_t depth_;
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  Queue queue_;                                        // oldest first
  std::map<Key, std::deque<Queue::iterator>> by_key_;  // ascending by number
  bool announced_ = true;                              // samples may have arrived before
};

}  // namespace topogeo::messaging::detail
