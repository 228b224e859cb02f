// Schedule of a replayed log's scans.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/service/replay_rate.hpp"

namespace topogeo::sensor_gateway {

class ReplayPace {
 public:
  /// Longer gaps in the log are replayed as kShortened_s, so that nobody waits for a lunch break.
  static constexpr std::int64_t kLongestGap_ns = 60'000'000'000;
  static constexpr double kShortened_s = 1.0;

  explicit ReplayPace(service::ReplayRate rate) : rate_(rate) {}

  struct Due {
    double after_s = 0.0;        ///< real time from the first scan to this one
    double shortened_gap_s = 0;  ///< length in the log of a shortened gap, else 0
  };
  /// Stamps must increase from call to call. The first scan is due at 0.
  Due next(std::int64_t stamp_ns);

 private:
  service::ReplayRate rate_;
  std::optional<std::int64_t> last_stamp_ns_;
  double after_s_ = 0.0;
};

}  // namespace topogeo::sensor_gateway
