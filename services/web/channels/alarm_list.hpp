// Troubles that a person must see: channel `alarms`. An alarm stays until an operator acknowledges
// it; the newest ones remain with who acknowledged them, and when. A file keeps them for the next
// service.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "channels/alarm.hpp"
#include "channels/alarm_file.hpp"
#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Thread-safe.
class AlarmList {
 public:
  /// With more alarms the oldest acknowledged ones go first.
  static constexpr std::size_t kKept = 200;

  /// `file` keeps the alarms; empty: none does. `not_kept` is called when they could not be written
  /// there. Throws like AlarmFile::open().
  explicit AlarmList(
      ChannelHub& hub, const std::filesystem::path& file = {},
      std::function<void()> not_kept = [] {});

  /// `level`: "warning" or "error". The same trouble again, before it is acknowledged, counts with
  /// the first one.
  void raise(std::int64_t wall_ns, const std::string& level, const std::string& source,
             const std::string& text);

  /// Returns those among the alarms that were not acknowledged before, as "source: text".
  std::vector<std::string> acknowledge(std::int64_t wall_ns, std::span<const std::uint64_t> numbers,
                                       const std::string& who);

 private:
  [[nodiscard]] static Edit shown(std::uint64_t number, const Alarm& alarm);
  /// Removes an alarm if there are too many.
  void forget_one(std::vector<Edit>& edits);
  void keep(std::uint64_t number);

  ChannelHub& hub_;
  std::function<void()> not_kept_;
  std::mutex mutex_;
  AlarmFile file_;
  Alarms alarms_;
  std::uint64_t last_ = 0;
};

}  // namespace topogeo::web
