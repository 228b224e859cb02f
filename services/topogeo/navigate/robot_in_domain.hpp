// The live robot that a command sends somewhere: its name, its domain, and the wait for it.
#pragma once

#include <chrono>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/patience.hpp"

#include "common/domain_view.hpp"
#include "navigate/goal_client.hpp"

namespace topogeo::cli {

struct RobotInDomain {
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;  ///< for planner and navigator
};

/// Adds --robot, --wait-seconds and the flags of add_domain_options; `robot` must outlive the app.
void add_robot_options(command_line::Command& app, RobotInDomain& robot);

/// Interval between two checks of a condition: too short for people to notice.
inline constexpr std::chrono::milliseconds kRobotTick{50};

/// Runs the loop until `condition` holds; false when the patience ends first, or after a signal.
template <class Condition>
bool wait_for(messaging::EventLoop& loop, support::Patience& patience, const Condition& condition) {
  while (!condition()) {
    if (patience.is_over(support::monotonic_s()) || loop.run_for(kRobotTick)) return condition();
  }
  return true;
}

/// Returns when planner and navigator are there, or after a signal. Throws std::runtime_error
/// naming the missing one.
void wait_for_services(messaging::EventLoop& loop, const RobotInDomain& robot,
                       const GoalClient& client);

/// Makes the robot stop and drop the goal that was sent. Repeats the order while the navigator
/// still has the goal: one that starts just then does not get it and drives on. False if the
/// navigator does not confirm it.
[[nodiscard]] bool call_off(messaging::EventLoop& loop, GoalClient& client);

/// The error after a call_off() that failed.
inline constexpr const char* kNotCalledOff =
    "the goal could not be cancelled: the robot may drive on";

/// Exit code after a signal.
int interrupted();

}  // namespace topogeo::cli
