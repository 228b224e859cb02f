// The newest message of each live topic for Foxglove. It is made when somebody wants it: a service
// that nobody watches spends nothing on it.
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
  std::uint64_t version = 0;  ///< 0: there is none yet
  std::int64_t time_ns = 0;   ///< when it came, by the wall clock
  std::shared_ptr<const std::string> json;
};

class FoxgloveFeed {
 public:
  /// Calls `on_change` after each change, in the thread that made it, without a lock held.
  void on_change(std::function<void()> handler);

  /// Replaces the message of a topic; `make` gives its JSON, in the thread that calls newest(). For
  /// any thread.
  void set(LiveTopic topic, std::function<std::string()> make);

  /// For any thread.
  [[nodiscard]] std::uint64_t version(LiveTopic topic) const;
  /// For one thread.
  [[nodiscard]] LiveMessage newest(LiveTopic topic) const;

 private:
  struct Entry {
    std::uint64_t version = 0;
    std::int64_t time_ns = 0;
    std::function<std::string()> make;
    std::shared_ptr<const std::string> json;  // of the reading thread alone
  };

  mutable std::mutex mutex_;
  std::array<std::shared_ptr<Entry>, kLiveTopics> entries_;
  std::function<void()> on_change_;
};

}  // namespace topogeo::web
