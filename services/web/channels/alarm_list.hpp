// Troubles that a person must see: channel `alarms`. An alarm stays until an operator acknowledges
// it; the newest ones remain with who acknowledged them, and when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "server/channel_hub.hpp"

namespace topogeo::web {

/// Thread-safe.
class AlarmList {
 public:
  /// With more alarms the oldest acknowledged ones go first.
  static constexpr std::size_t kKept = 200;

  explicit AlarmList(ChannelHub& hub) : hub_(hub) {}

  /// `level`: "warning" or "error". The same trouble again, before it is acknowledged, counts with
  /// the first one.
  void raise(std::int64_t wall_ns, const std::string& level, const std::string& source,
             const std::string& text);

  /// Returns those among the alarms that were not acknowledged before, as "source: text".
  std::vector<std::string> acknowledge(std::int64_t wall_ns, std::span<const std::uint64_t> numbers,
                                       const std::string& who);

 private:
  struct Alarm {
    std::string level;
    std::string source;
    std::string text;
    std::int64_t first_ns = 0;
    std::int64_t last_ns = 0;
    std::uint64_t count = 0;
    std::string acknowledged_by{};  // empty: nobody yet
    std::int64_t acknowledged_ns = 0;
  };
  [[nodiscard]] static Edit shown(std::uint64_t number, const Alarm& alarm);
  /// Removes an alarm if there are too many.
  void forget_one(std::vector<Edit>& edits);

  ChannelHub& hub_;
  std::mutex mutex_;
  std::map<std::uint64_t, Alarm> alarms_;  // by number
  std::uint64_t last_ = 0;
};

}  // namespace topogeo::web
