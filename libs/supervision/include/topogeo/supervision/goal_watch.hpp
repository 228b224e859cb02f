// Decides when a goal is reached or must be given up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/support/patience.hpp"

namespace topogeo::supervision {

struct GoalEnd {
  bool arrived = false;
  std::string reason;  ///< the reason if not arrived
};

/// A planner's answer to a goal.
struct RouteAnswer {
  std::uint64_t goal_id = 0;
  bool refused = false;  ///< there is no route, and another pose or map will not change that
  std::string reason;    ///< why there is no route, for people; may be empty
};

/// The caller passes the time, in seconds from any start. It counts as in support::PatienceClock,
/// and not at all while the robot's services are short of CPU time.
class GoalWatch {
 public:
  /// Gives up when the robot has not driven for `patience_s`; a pause does not count.
  GoalWatch(std::uint64_t goal_id, double patience_s, double now_s)
      : goal_id_(goal_id), patience_s_(patience_s), clock_(now_s) {}

  /// Ignores answers to other goals.
  void add(const RouteAnswer& answer);
  void add(const navigation::NavigatorStatus& status, double now_s);
  /// Empty as long as the robot may still arrive.
  [[nodiscard]] std::optional<GoalEnd> check(double now_s);
  /// Whether another program replaced or cancelled the goal. A navigator that started again without
  /// the goal counts after some seconds.
  [[nodiscard]] bool was_taken_away() const;
  /// Whether the navigator has the goal and has not ended it, by its newest status.
  [[nodiscard]] bool in_hand() const;
  /// Whether the services of the robot are short of CPU time from now on.
  void set_busy(bool busy, double now_s);

 private:
  /// Returns the current time of the patience clock, which all times below use.
  double pass_time(double now_s);
  [[nodiscard]] std::optional<GoalEnd> judge(const navigation::NavigatorStatus& status) const;

  std::uint64_t goal_id_;
  double patience_s_;
  support::PatienceClock clock_;
  bool busy_ = false;
  double alive_s_ = 0.0;   // last status of the navigator
  double driven_s_ = 0.0;  // the robot last drove, or was paused
  bool taken_ = false;
  bool replaced_ = false;
  std::optional<double> without_s_;  // the navigator lost the goal
  RouteAnswer answer_;
  std::optional<navigation::NavigatorStatus> status_;
};

}  // namespace topogeo::supervision
