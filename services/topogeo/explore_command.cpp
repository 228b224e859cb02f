// topogeo explore: sends a mapping robot from frontier to frontier until nothing is left.
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>

#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/render/picture_format.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "commands.hpp"
#include "domain_view.hpp"
#include "explore_session.hpp"
#include "run_log.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTick{50};
constexpr double kLastWord_s = 5.0;  // for the robot to have the order, and to stop

struct ExploreOptions {
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;
  std::optional<std::filesystem::path> picture;
};

void call_off(messaging::EventLoop& loop, ExploreSession& session) {
  session.client().cancel();
  static_cast<void>(session.client().delivered(kLastWord_s));
  const double end_s = support::monotonic_s() + kLastWord_s;
  while (!session.stands() && support::monotonic_s() < end_s) loop.run_for(kTick);
}

int explore(const ExploreOptions& options) {
  if (options.picture) {
    try {
      static_cast<void>(render::picture_format(*options.picture));
    } catch (const std::exception& error) {
      throw service::UsageError(error.what());
    }
  }
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant = join(options.view, "topogeo/explore");
  ExploreSession session(participant, loop, options.robot_id);
  const double start_s = support::monotonic_s();
  while (!session.client().missing().empty() || !session.client().status()) {
    if (loop.run_for(kTick)) return kSignalBase + messaging::SignalStop::received();
    if (support::monotonic_s() - start_s < options.wait_s) continue;
    const std::string missing = session.client().missing();
    throw std::runtime_error(nothing_alive(options.view, missing.empty() ? "navigator" : missing));
  }
  while (!session.done() && session.trouble().empty()) {
    if (loop.run_for(kTick)) break;
    session.tick();
  }
  call_off(loop, session);
  std::cerr << '\n';
  if (options.picture) session.write_picture(*options.picture);
  if (messaging::SignalStop::received() != 0) {
    std::cerr << "topogeo: stopped; " << session.summary() << '\n';
    return kSignalBase + messaging::SignalStop::received();
  }
  if (!session.trouble().empty()) throw std::runtime_error(session.trouble());
  std::cout << session.summary() << '\n';
  return service::kOk;
}

}  // namespace

void add_explore_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "explore", "Send a mapping robot everywhere that it can get to and has not seen");
  auto options = std::make_shared<ExploreOptions>();
  command->add_option("--picture", options->picture, "write map and way as .png or .svg at the end")
      ->type_name("FILE");
  command->add_option("--robot,--robot-id", options->robot_id, "which robot")
      ->capture_default_str();
  add_domain_options(*command, options->view);
  constexpr double kLongestWait_s = 3600.0;
  command
      ->add_option("--wait-seconds", options->wait_s, "how long to wait for planner and navigator")
      ->check(CLI::Range(0.1, kLongestWait_s))
      ->capture_default_str();
  command->footer(
      "Needs the services of a mapping robot, planner and navigator among them. Ctrl-C "
      "stops the robot; the map stays.");
  command->callback([options, &exit_code] { exit_code = explore(*options); });
}

}  // namespace topogeo::cli
