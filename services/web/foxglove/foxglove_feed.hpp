// The newest message of each live topic for Foxglove, made on demand: a service without viewers
// spends nothing on it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "foxglove/foxglove_topics.hpp"

namespace topogeo::web {

struct LiveMessage {
  std::uint64_t version = 0;  ///< 0: none yet
  std::int64_t time_ns = 0;   ///< arrival by the wall clock
  std::shared_ptr<const std::string> json;
};

class FoxgloveFeed {
 public:
  /// Calls `on_change` after each change, in the thread that made it, without holding a lock.
  void on_change(std::function<void()> handler);

  /// Replaces the message of a topic; newest() calls `make` for its JSON in the reading thread.
  /// Thread-safe.
  void set(LiveTopic topic, std::function<std::string()> make);

  /// Thread-safe.
  [[nodiscard]] std::uint64_t version(LiveTopic topic) const;
  /// For a single thread.
  [[nodiscard]] LiveMessage newest(LiveTopic topic) const;

 private:
  struct Entry {
    std::uint64_t version = 0;
    std::int64_t time_ns = 0;
    std::function<std::string()> make;
    std::shared_ptr<const std::string> json;  // used only by the reading thread
  };

  mutable std::mutex mutex_;
  std::array<std::shared_ptr<Entry>, kLiveTopics> entries_;
  std::function<void()> on_change_;
};

}  // namespace topogeo::web
