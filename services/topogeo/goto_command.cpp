// topogeo goto: sends a robot somewhere and shows how it gets there.
#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "commands.hpp"
#include "domain_view.hpp"
#include "goal_session.hpp"
#include "run_log.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTick{50};
constexpr double kLastWord_s = 5.0;  // for the robot to have an order, and to stop

struct GotoOptions {
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;
  GoalOptions goal;
  bool no_wait = false;
  bool cancel = false;
  bool pause = false;
  bool resume = false;

  [[nodiscard]] bool is_order() const { return cancel || pause || resume; }
};

/// Runs the loop until `condition` holds; false when it does not within `patience_s` or a signal
/// comes.
template <class Condition>
bool wait_for(messaging::EventLoop& loop, double patience_s, const Condition& condition) {
  const double end_s = support::monotonic_s() + patience_s;
  while (!condition()) {
    if (support::monotonic_s() > end_s || loop.run_for(kTick)) return condition();
  }
  return true;
}

void wait_for_services(messaging::EventLoop& loop, const GotoOptions& options, GoalClient& client) {
  if (wait_for(loop, options.wait_s,
               [&] { return client.missing().empty() && client.status().has_value(); })) {
    return;
  }
  if (messaging::SignalStop::received() != 0) return;
  const std::string missing = client.missing();
  throw std::runtime_error(nothing_alive(options.view, missing.empty() ? "navigator" : missing));
}

int interrupted() {
  return kSignalBase + messaging::SignalStop::received();
}

/// The robot stops and forgets the goal.
void call_off(messaging::EventLoop& loop, GoalSession& session) {
  session.client().cancel();
  static_cast<void>(session.client().delivered(kLastWord_s));
  static_cast<void>(wait_for(loop, kLastWord_s, [&] { return session.stands(); }));
}

int send_order(const GotoOptions& options) {
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant = join(options.view, "topogeo/goto");
  GoalClient client(participant, loop, options.robot_id);
  wait_for_services(loop, options, client);
  if (messaging::SignalStop::received() != 0) return interrupted();
  service::Goal order;
  order.kind =
      options.cancel ? msg::kGoalCancel : (options.pause ? msg::kGoalPause : msg::kGoalResume);
  client.send(order);
  if (!client.delivered(options.wait_s)) throw std::runtime_error("the order could not be sent");
  const bool done = wait_for(loop, options.wait_s, [&] {
    const bool paused = client.status()->reason() == msg::kHaltPaused;
    if (options.pause) return paused || client.status()->goal_id() == 0;
    if (options.resume) return !paused;
    return client.status()->state() != msg::kNavigatorDriving;
  });
  std::cout << progress_line(*client.status()) << '\n';
  if (done) return service::kOk;
  throw std::runtime_error(
      fmt::format("robot '{}' did not do it within {:.0f} s", options.robot_id, options.wait_s));
}

int go_there(const GotoOptions& options) {
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant = join(options.view, "topogeo/goto");
  GoalSession session(participant, loop, options.robot_id, options.goal);
  wait_for_services(loop, options, session.client());
  if (messaging::SignalStop::received() != 0) return interrupted();
  session.send();
  if (options.no_wait) {
    if (!session.client().delivered(options.wait_s) ||
        !wait_for(loop, options.wait_s, [&] { return session.client().taken(); })) {
      throw std::runtime_error("the navigator does not take the goal");
    }
    return service::kOk;
  }
  while (!session.end()) {
    if (loop.run_for(kTick)) break;
    session.tick();
  }
  session.progress().finish();
  if (messaging::SignalStop::received() != 0) {
    call_off(loop, session);
    std::cerr << "topogeo: stopped, the goal is cancelled\n";
    return interrupted();
  }
  const GoalEnd end = *session.end();
  if (end.arrived) return service::kOk;
  call_off(loop, session);  // it must not set out when nobody expects it any more
  throw std::runtime_error(end.reason);
}

}  // namespace

void add_goto_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("goto", "Send a robot to a place and watch it get there");
  auto options = std::make_shared<GotoOptions>();
  CLI::Option* target =
      command->add_option("target", options->goal.target, "where to: a point, a node or a place")
          ->type_name("PLACE|X,Y|#NODE");
  add_goal_options(*command, options->goal);
  command->add_flag("--no-wait", options->no_wait, "do not wait until it is there");
  CLI::Option* cancel =
      command->add_flag("--cancel", options->cancel, "stop and forget the goal that it has");
  CLI::Option* pause = command->add_flag("--pause", options->pause, "stop and keep the goal");
  CLI::Option* resume = command->add_flag("--resume", options->resume, "drive on after a pause");
  cancel->excludes(pause)->excludes(resume)->excludes(target);
  pause->excludes(resume)->excludes(target);
  resume->excludes(target);
  command->add_option("--robot,--robot-id", options->robot_id, "which robot")
      ->capture_default_str();
  add_domain_options(*command, options->view);
  constexpr double kLongestWait_s = 3600.0;
  command
      ->add_option("--wait-seconds", options->wait_s, "how long to wait for planner and navigator")
      ->check(CLI::Range(0.1, kLongestWait_s))
      ->capture_default_str();
  command->footer(
      "Ctrl-C stops the robot. Where this program is killed the robot drives on to its goal.");
  command->callback([options, target, &exit_code] {
    if (!options->is_order() && target->count() == 0) {
      throw service::UsageError(
          "goto: expected a goal, --cancel, --pause or --resume (see --help)");
    }
    exit_code = options->is_order() ? send_order(*options) : go_there(*options);
  });
}

}  // namespace topogeo::cli
