// Recent events as sentences: channel `events`.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Thread-safe.
class EventLog {
 public:
  enum class Level : std::uint8_t { kInfo, kWarning, kError };
  static constexpr std::uint64_t kKept = 500;

  explicit EventLog(ChannelHub& hub) : hub_(hub) {}

  /// `source`: service or part of the robot.
  void add(Level level, const std::string& source, const std::string& sentence);

 private:
  ChannelHub& hub_;
  std::mutex mutex_;
  std::uint64_t last_ = 0;
};

}  // namespace topogeo::web
