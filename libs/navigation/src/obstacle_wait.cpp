#include "obstacle_wait.hpp"

#include <algorithm>

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {

void ObstacleWait::begin(std::int64_t now_ns, double driven_m) {
  if (since_ns_) return;
  since_ns_ = now_ns;
  driven_m_ = driven_m;
}

void ObstacleWait::drive_on(double driven_m) {
  constexpr double kProgress_m = 0.1;  // less may be the last bit up to the obstacle
  if (since_ns_ && driven_m > driven_m_ + kProgress_m) forget();
}

void ObstacleWait::forget() {
  since_ns_.reset();
  reported_ = false;
}

void ObstacleWait::set_reported(std::int64_t now_ns) {
  reported_ = true;
  reported_ns_ = now_ns;
}

bool ObstacleWait::over(std::int64_t now_ns) const {
  return since_ns_ && elapsed_s(*since_ns_, now_ns) >= config_.move_away_s;
}

bool ObstacleWait::report_due(std::int64_t now_ns) const {
  return since_ns_ && !reported_ && elapsed_s(*since_ns_, now_ns) >= config_.report_s;
}

HaltReason ObstacleWait::reason() const {
  return reported_ ? HaltReason::kWaitsForRoute : HaltReason::kObstacle;
}

std::string ObstacleWait::message(const std::string& what, std::int64_t now_ns) const {
  if (!reported_) {
    const double waited_s = since_ns_ ? elapsed_s(*since_ns_, now_ns) : 0.0;
    return fmt::format("{}; waits {:.0f} s, then looks for another route", what,
                       std::max(0.0, config_.move_away_s - waited_s));
  }
  const double waited_s = elapsed_s(reported_ns_, now_ns);
  if (waited_s < config_.answer_s) return what + "; requests another route";
  return fmt::format("{}; the planner has not answered for {:.0f} s", what, waited_s);
}

}  // namespace topogeo::navigation
