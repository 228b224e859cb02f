// The services of a run that have died: when each is started again, and how long it was away.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace topogeo::cli {

/// Services have the names of their processes. Has no clock: the caller passes the time, in seconds
/// from any start.
class RestartLog {
 public:
  static constexpr std::chrono::milliseconds kFirstDelay{100};
  static constexpr std::chrono::milliseconds kLongestDelay{5000};
  /// A service that was at work for so long before it died did not die of its start.
  static constexpr double kSettled_s = 5.0;

  struct Restart {
    std::chrono::milliseconds delay{};  ///< until it is to be started again
    std::uint32_t number = 0;           ///< how often it was started again, this one included
  };

  /// The service has died. One that dies again and again waits twice as long each time.
  Restart died(const std::string& name, double now_s);
  /// The service is at work. Returns how long it was away, seconds; nothing when it was not.
  std::optional<double> at_work(const std::string& name, double now_s);
  [[nodiscard]] bool is_away(const std::string& name) const { return away_since_s_.contains(name); }
  /// Those that have died and are not at work again, in order.
  [[nodiscard]] std::vector<std::string> away() const;
  /// All services are started anew.
  void clear();

 private:
  std::map<std::string, std::uint32_t> restarts_;
  std::map<std::string, std::uint32_t> deaths_in_row_;  // without settled work between
  std::map<std::string, double> away_since_s_;
  std::map<std::string, double> at_work_since_s_;  // those that were started again
};

}  // namespace topogeo::cli
