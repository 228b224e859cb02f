// Samples that have arrived at a reader that keeps the last ones, until the program takes them.
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
  std::shared_ptr<void> message = {};  ///< null where nothing can be read of it: a disposal
};

/// Keeps the newest `depth` samples of each instance and writer. The history of the middleware
/// keeps so many of each instance, whoever wrote them: there a stranger's sample takes the place of
/// a peer's that nobody has read yet and that is never sent again, because it was acknowledged.
///
/// For one thread that takes and any that put.
class Arrivals {
 public:
  /// `capacity`: samples of all instances and writers, beyond which is_full().
  Arrivals(std::size_t depth, std::size_t capacity) : depth_(depth), capacity_(capacity) {}

  /// Samples are in the middleware that were not put here.
  void announce();
  /// announce() or a true is_full() since the last call.
  bool take_announced();

  /// Adds samples; those of one writer may come in any order within a batch.
  void put(std::vector<Arrival> batch);

  /// Takes the one that waits the longest; those of a writer come in the order of their numbers.
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
  bool announced_ = true;                              // some may have come before
};

}  // namespace topogeo::messaging::detail
