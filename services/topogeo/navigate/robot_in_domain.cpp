#include "navigate/robot_in_domain.hpp"

#include <stdexcept>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"

#include "commands.hpp"
#include "run/run_log.hpp"

namespace topogeo::cli {

void add_robot_options(command_line::Command& app, RobotInDomain& robot) {
  add_robot_option(app, robot.robot_id, "name of the robot");
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

bool call_off(messaging::EventLoop& loop, GoalClient& client) {
  constexpr double kLastWord_s = 5.0;     // time for the robot to get the order and to stop
  constexpr std::uint64_t kStatuses = 3;  // between repeats, as some may be older than the order
  if (!client.has_sent()) return true;
  client.cancel();
  support::Patience patience(kLastWord_s, support::monotonic_s());
  std::uint64_t before = client.statuses();
  const bool ended = wait_for(loop, patience, [&] {
    if (client.in_hand() && client.statuses() >= before + kStatuses) {
      client.cancel();
      before = client.statuses();
    }
    return client.statuses() > before && !client.in_hand() && (!client.taken() || client.stands());
  });
  // The goal itself may still be under way to the navigator, with the cancel behind it.
  return client.delivered(patience) && ended;
}

int interrupted() {
  return kSignalBase + messaging::SignalStop::received();
}

}  // namespace topogeo::cli
