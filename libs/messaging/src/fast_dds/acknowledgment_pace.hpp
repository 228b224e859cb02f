// How often a reader is asked to acknowledge what it got.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>

namespace topogeo::messaging {

/// Readers are told apart by any address of theirs. For several threads.
class AcknowledgmentPace {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Messages with `pause` (> 0) or more between them are all to be acknowledged, since nothing
  /// would be saved: the writer's own heartbeat would ask soon. Of a stream of messages one each
  /// `period` is.
  AcknowledgmentPace(std::chrono::nanoseconds pause, std::chrono::nanoseconds period)
      : pause_(pause), period_(period) {}

  /// A message goes to `reader` now: true when it is to be acknowledged.
  [[nodiscard]] bool due(const void* reader, Time now);

  /// Readers that are remembered.
  [[nodiscard]] std::size_t readers() const;

 private:
  struct Reader {
    Time sent;
    Time asked;
  };

  const std::chrono::nanoseconds pause_;
  const std::chrono::nanoseconds period_;
  mutable std::mutex mutex_;
  std::map<const void*, Reader> readers_;
  Time forgotten_{};
};

}  // namespace topogeo::messaging
