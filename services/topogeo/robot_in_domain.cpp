#include "robot_in_domain.hpp"

#include <stdexcept>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"

#include "commands.hpp"
#include "run_log.hpp"

namespace topogeo::cli {

void add_robot_options(command_line::Command& app, RobotInDomain& robot) {
  add_robot_option(app, robot.robot_id, "which robot");
  add_domain_options(app, robot.view);
  app.add_option("--wait-seconds", robot.wait_s, "how long to wait for planner and navigator")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

void wait_for_services(messaging::EventLoop& loop, const RobotInDomain& robot,
                       const GoalClient& client) {
  support::Patience patience(robot.wait_s, support::monotonic_s());
  if (wait_for(loop, patience,
               [&] { return client.missing().empty() && client.status().has_value(); })) {
    return;
  }
  if (messaging::SignalStop::received() != 0) return;
  const std::string missing = client.missing();
  throw std::runtime_error(nothing_alive(robot.view, (missing.empty() ? "navigator" : missing) +
                                                         " of robot '" + robot.robot_id + "'") +
                           patience.reason());
}

void call_off(messaging::EventLoop& loop, GoalClient& client) {
  constexpr double kLastWord_s = 5.0;  // time for the robot to get the order and to stop
  client.cancel();
  support::Patience patience(kLastWord_s, support::monotonic_s());
  static_cast<void>(client.delivered(patience));
  patience.begin_again(support::monotonic_s());
  static_cast<void>(wait_for(loop, patience, [&] { return client.stands(); }));
}

int interrupted() {
  return kSignalBase + messaging::SignalStop::received();
}

}  // namespace topogeo::cli
