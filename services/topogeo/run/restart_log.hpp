// Services of a run that have died: when each is restarted, and how long it was away.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/msg/status.h"

namespace topogeo::cli {

/// Services are named like their processes. Has no clock: the caller passes the time, in seconds
/// from any start.
class RestartLog {
 public:
  static constexpr std::chrono::milliseconds kFirstDelay{100};
  static constexpr std::chrono::milliseconds kLongestDelay{5000};
  /// A service that worked for so long before it died did not die from its start.
  static constexpr double kSettled_s = 5.0;

  struct Restart {
    std::chrono::milliseconds delay{};  ///< until the restart
    std::uint32_t number = 0;           ///< number of restarts, including this one
  };

  /// Records a death. A service that dies repeatedly waits twice as long each time.
  Restart died(const std::string& name, double now_s);
  /// The service works. Returns how long it was away, seconds; nothing when it was not.
  std::optional<double> at_work(const std::string& name, double now_s);
  [[nodiscard]] bool is_away(const std::string& name) const { return away_since_s_.contains(name); }
  /// The services that have died and do not work again yet, in order.
  [[nodiscard]] std::vector<std::string> away() const;
  /// Forgets the absences, because all services are restarted.
  void clear();

 private:
  std::map<std::string, std::uint32_t> restarts_;
  std::map<std::string, std::uint32_t> deaths_in_row_;  // without settled work in between
  std::map<std::string, double> away_since_s_;
  std::map<std::string, double> at_work_since_s_;  // restarted services
};

/// Whether a service in this state works, or has worked since its start. A log that was read before
/// is finished without a moment at work. One that waits is still away: a source waits for its
/// readers, perhaps for a recorder that never comes back.
[[nodiscard]] bool has_worked(msg::ServiceState state);

}  // namespace topogeo::cli
