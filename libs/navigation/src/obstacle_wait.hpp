// Patience of a robot before an obstacle: it waits for it to move away, then reports it so that the
// planner finds another route, and waits for that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct ObstacleWaitConfig {
  double move_away_s = 4.0;  ///< for movable obstacles
  double report_s = 4.3;     ///< until the report, not less: a long detour is tried in between
  double answer_s = 5.0;     ///< for the planner's answer; later it is late
};

class ObstacleWait {
 public:
  explicit ObstacleWait(const ObstacleWaitConfig& config) : config_(config) {}

  /// The robot stands before an obstacle; ignored while it waits. `driven_m`: for its goal so far.
  void begin(std::int64_t now_ns, double driven_m);
  /// The robot drives: after a short distance the obstacle is behind it.
  void drive_on(double driven_m);
  /// Ends the wait; the report remains.
  void end() { since_ns_.reset(); }
  void forget();
  void set_reported(std::int64_t now_ns);

  [[nodiscard]] bool waits() const { return since_ns_.has_value(); }
  /// Whether the obstacle has had its time to move away.
  [[nodiscard]] bool over(std::int64_t now_ns) const;
  /// Whether the obstacle should be reported now.
  [[nodiscard]] bool report_due(std::int64_t now_ns) const;
  [[nodiscard]] bool reported() const { return reported_; }

  /// The reason of the wait, while it waits.
  [[nodiscard]] HaltReason reason() const;
  /// One line for people that begins with the obstacle.
  [[nodiscard]] std::string message(const std::string& what, std::int64_t now_ns) const;

 private:
  ObstacleWaitConfig config_;
  std::optional<std::int64_t> since_ns_;
  double driven_m_ = 0.0;  ///< at the begin
  bool reported_ = false;
  std::int64_t reported_ns_ = 0;
};

}  // namespace topogeo::navigation
