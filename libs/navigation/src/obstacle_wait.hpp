// The patience of a robot that stands before something: first it waits for that to move away, then
// it is reported so that the planner finds another route, and that route is waited for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct ObstacleWaitConfig {
  double move_away_s = 4.0;  ///< for what may move away
  double report_s = 4.3;     ///< until it is reported, not less: a long detour is tried between
  double answer_s = 5.0;     ///< for the planner to answer; later it is late
};

class ObstacleWait {
 public:
  explicit ObstacleWait(const ObstacleWaitConfig& config) : config_(config) {}

  /// It stands before something, unless it does already; `driven_m` so far, for its goal.
  void begin(std::int64_t now_ns, double driven_m);
  /// It drives: what it waited for is behind it after a short distance.
  void drive_on(double driven_m);
  /// It waits no more; what was reported stays so.
  void end() { since_ns_.reset(); }
  void forget();
  void set_reported(std::int64_t now_ns);

  [[nodiscard]] bool waits() const { return since_ns_.has_value(); }
  /// What is in the way has had its time to move away.
  [[nodiscard]] bool over(std::int64_t now_ns) const;
  /// It is time to report what is in the way.
  [[nodiscard]] bool report_due(std::int64_t now_ns) const;
  [[nodiscard]] bool reported() const { return reported_; }

  /// What it waits for, while it waits.
  [[nodiscard]] HaltReason reason() const;
  /// One line for people, that begins with what is in the way.
  [[nodiscard]] std::string message(const std::string& what, std::int64_t now_ns) const;

 private:
  ObstacleWaitConfig config_;
  std::optional<std::int64_t> since_ns_;
  double driven_m_ = 0.0;  ///< when it began
  bool reported_ = false;
  std::int64_t reported_ns_ = 0;
};

}  // namespace topogeo::navigation
