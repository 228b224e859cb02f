// Whether a goal was reached, or when there is no more hope of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/msg/planning.h"

namespace topogeo::cli {

struct GoalEnd {
  bool arrived = false;
  std::string reason;  ///< why not; empty when arrived
};

/// The caller passes the time, in seconds from any start.
class GoalWatch {
 public:
  /// Given up when the robot has not driven for `patience_s`; a pause does not count.
  GoalWatch(std::uint64_t goal_id, double patience_s, double now_s)
      : goal_id_(goal_id), patience_s_(patience_s), alive_s_(now_s), driven_s_(now_s) {}

  /// A route or a refusal of the planner; those for other goals do not matter.
  void add(const msg::Route& route);
  void add(const msg::NavigatorStatus& status, double now_s);
  /// Nothing as long as it may still arrive.
  [[nodiscard]] std::optional<GoalEnd> look(double now_s) const;

 private:
  [[nodiscard]] std::optional<GoalEnd> judge(const msg::NavigatorStatus& status) const;

  std::uint64_t goal_id_;
  double patience_s_;
  double alive_s_;   // the navigator said something
  double driven_s_;  // the robot drove, or was paused
  bool taken_ = false;
  bool replaced_ = false;
  std::optional<msg::RouteStatus> route_;
  std::string refusal_;
  std::optional<msg::NavigatorStatus> status_;
};

}  // namespace topogeo::cli
