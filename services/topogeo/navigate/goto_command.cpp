// topogeo goto: sends a robot to a place and shows its progress.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "commands.hpp"
#include "navigate/goal_session.hpp"
#include "navigate/robot_in_domain.hpp"
#include "run/run_log.hpp"

namespace topogeo::cli {
namespace {

struct GotoOptions {
  RobotInDomain robot;
  GoalOptions goal;
  bool no_wait = false;
  bool cancel = false;
  bool pause = false;
  bool resume = false;

  [[nodiscard]] bool is_order() const { return cancel || pause || resume; }
};

int send_order(const GotoOptions& options) {
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant =
      join_for(options.robot.view, "topogeo/goto", options.robot.robot_id);
  GoalClient client(participant, loop, options.robot.robot_id);
  wait_for_services(loop, options.robot, client);
  if (messaging::SignalStop::received() != 0) return interrupted();
  service::Goal order;
  order.kind =
      options.cancel ? msg::kGoalCancel : (options.pause ? msg::kGoalPause : msg::kGoalResume);
  client.send(order);
  support::Patience patience(options.robot.wait_s, support::monotonic_s());
  if (!client.delivered(patience)) {
    throw std::runtime_error("the order could not be sent" + patience.reason());
  }
  patience.begin_again(support::monotonic_s());
  const bool done = wait_for(loop, patience, [&] {
    const bool paused = client.status()->reason == navigation::HaltReason::kPaused;
    if (options.pause) return paused || client.status()->goal_id == 0;
    if (options.resume) return !paused;
    return client.status()->state != navigation::NavigatorState::kDriving;
  });
  std::cout << supervision::progress_line(*client.status()) << '\n';
  if (done) return service::kOk;
  throw std::runtime_error(fmt::format("robot '{}' did not carry out the order within {:.0f} s{}",
                                       options.robot.robot_id, options.robot.wait_s,
                                       patience.reason()));
}

int go_there(const GotoOptions& options) {
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant =
      join_for(options.robot.view, "topogeo/goto", options.robot.robot_id);
  GoalSession session(participant, loop, options.robot.robot_id, options.goal);
  wait_for_services(loop, options.robot, session.client());
  if (messaging::SignalStop::received() != 0) return interrupted();
  session.send();
  if (options.no_wait) {
    support::Patience patience(options.robot.wait_s, support::monotonic_s());
    if (!session.client().delivered(patience) ||
        !wait_for(loop, patience, [&] { return session.client().taken(); })) {
      throw std::runtime_error("the navigator does not take the goal" + patience.reason());
    }
    return service::kOk;
  }
  bool busy_reported = false;
  while (!session.end()) {
    if (loop.run_for(kRobotTick)) break;
    session.tick();
    if (const std::string busy = session.client().too_busy(); !busy.empty() && !busy_reported) {
      busy_reported = true;
      session.progress().print(busy + "; the drive takes longer");
    }
  }
  session.progress().finish();
  if (messaging::SignalStop::received() != 0) {
    if (!call_off(loop, session.client())) throw std::runtime_error(kNotCalledOff);
    std::cerr << "topogeo: stopped, the goal is cancelled\n";
    return interrupted();
  }
  const supervision::GoalEnd end = *session.end();
  if (end.arrived) return service::kOk;
  // The robot must not set out when no program waits for it any more.
  const bool called_off = call_off(loop, session.client());
  throw std::runtime_error(called_off ? end.reason : end.reason + "; " + kNotCalledOff);
}

}  // namespace

void add_goto_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("goto", "Send a robot to a place and watch it get there");
  auto options = std::make_shared<GotoOptions>();
  command_line::Option* target =
      command->add_option("target", options->goal.target, "goal: a point, a node or a place")
          ->type_name("PLACE|X,Y|#NODE");
  add_goal_options(*command, options->goal);
  command->add_flag("--no-wait", options->no_wait, "do not wait for the arrival");
  command_line::Option* cancel =
      command->add_flag("--cancel", options->cancel, "stop and drop the current goal");
  command_line::Option* pause =
      command->add_flag("--pause", options->pause, "stop and keep the goal");
  command_line::Option* resume =
      command->add_flag("--resume", options->resume, "drive on after a pause");
  cancel->excludes(pause)->excludes(resume)->excludes(target);
  pause->excludes(resume)->excludes(target);
  resume->excludes(target);
  add_robot_options(*command, options->robot);
  command->footer(
      "Ctrl-C stops the robot. If this program is killed, the robot drives on to its goal.");
  command->callback([options, target, &exit_code] {
    if (!options->is_order() && target->count() == 0) {
      throw service::UsageError(
          "goto: expected a goal, --cancel, --pause or --resume (see --help)");
    }
    exit_code = options->is_order() ? send_order(*options) : go_there(*options);
  });
}

}  // namespace topogeo::cli
