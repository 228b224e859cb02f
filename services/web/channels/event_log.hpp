// Recent events as sentences: channel `events`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "channels/alarm_list.hpp"
#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Thread-safe.
class EventLog {
 public:
  enum class Level : std::uint8_t { kInfo, kWarning, kError };
  static constexpr std::uint64_t kKept = 500;

  explicit EventLog(ChannelHub& hub) : hub_(hub), alarms_(hub) {}
  /// Keeps the alarms in a file; see AlarmList.
  EventLog(ChannelHub& hub, const std::filesystem::path& alarms, std::function<void()> not_kept)
      : hub_(hub), alarms_(hub, alarms, std::move(not_kept)) {}

  /// `source`: service or part of the robot.
  void add(Level level, const std::string& source, const std::string& sentence);
  /// The same for an event that also stays as an alarm until somebody acknowledges it.
  void alarm(Level level, const std::string& source, const std::string& sentence);
  /// `who`: name of the operator; it stands in the events, too.
  void acknowledge(std::span<const std::uint64_t> alarms, const std::string& who);

 private:
  ChannelHub& hub_;
  AlarmList alarms_;
  std::mutex mutex_;
  std::uint64_t last_ = 0;
};

}  // namespace topogeo::web
