// Lateness of a message: how much longer it took from the page than the fastest one on the same
// connection. The clocks of page and service need only the same rate.
#pragma once

#include <algorithm>
#include <optional>

namespace topogeo::web {

class TransitClock {
 public:
  /// Bound of the drift between two clocks; the fastest transit ages at this rate.
  static constexpr double kDrift = 2e-4;

  /// Seconds, 0 for the fastest message. `sent_s`: by the clock of the page; `came_s`: by that of
  /// the service, never going back; both from any start.
  double lateness_s(double sent_s, double came_s) {
    const double transit_s = came_s - sent_s;
    const double drifted_s = quickest_s_ ? *quickest_s_ + kDrift * (came_s - last_s_) : transit_s;
    quickest_s_ = std::min(drifted_s, transit_s);
    last_s_ = came_s;
    return transit_s - *quickest_s_;
  }

 private:
  std::optional<double> quickest_s_;
  double last_s_ = 0.0;
};

}  // namespace topogeo::web
