// A live robot that a command sends somewhere: which one, on which domain, and waiting for it.
#pragma once

#include <chrono>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/patience.hpp"

#include "domain_view.hpp"
#include "goal_client.hpp"

namespace topogeo::cli {

struct RobotInDomain {
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;  ///< for planner and navigator
};

/// Adds --robot, --wait-seconds and what add_domain_options does; `robot` must outlive the app.
void add_robot_options(command_line::Command& app, RobotInDomain& robot);

/// Between two checks of a condition: people notice no wait of that length.
inline constexpr std::chrono::milliseconds kRobotTick{50};

/// Runs the loop until `condition` holds; false when the patience is over before, or a signal
/// comes.
template <class Condition>
bool wait_for(messaging::EventLoop& loop, support::Patience& patience, const Condition& condition) {
  while (!condition()) {
    if (patience.is_over(support::monotonic_s()) || loop.run_for(kRobotTick)) return condition();
  }
  return true;
}

/// Comes back when planner and navigator are there, or at a signal. Throws std::runtime_error that
/// names what is missing.
void wait_for_services(messaging::EventLoop& loop, const RobotInDomain& robot,
                       const GoalClient& client);

/// The robot stops and forgets the goal that was sent.
void call_off(messaging::EventLoop& loop, GoalClient& client);

/// Exit code after a signal.
int interrupted();

}  // namespace topogeo::cli
