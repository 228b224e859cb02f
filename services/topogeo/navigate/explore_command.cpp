// topogeo explore: sends a mapping robot from frontier to frontier until nothing is left.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "common/configuration.hpp"
#include "navigate/explore_session.hpp"
#include "navigate/goal_session.hpp"
#include "navigate/robot_in_domain.hpp"

namespace topogeo::cli {
namespace {

struct ExploreOptions {
  RobotInDomain robot;
  std::optional<std::filesystem::path> picture;
  std::optional<std::filesystem::path> config;
};

int explore(const ExploreOptions& options) {
  check_picture(options.picture);
  const navigation::TourConfig config = read_config(options.config).exploration;
  messaging::EventLoop loop;
  const messaging::SignalStop signals([&](int) { loop.stop(); });
  const messaging::Participant participant =
      join_for(options.robot.view, "topogeo/explore", options.robot.robot_id);
  ExploreSession session(participant, loop, options.robot.robot_id, config);
  wait_for_services(loop, options.robot, session.client());
  if (messaging::SignalStop::received() != 0) return interrupted();
  while (!session.done() && session.trouble().empty()) {
    if (loop.run_for(kRobotTick)) break;
    session.tick();
  }
  const bool called_off = call_off(loop, session.client());
  std::cerr << '\n';
  if (options.picture) session.write_picture(*options.picture);
  if (!called_off) throw std::runtime_error(kNotCalledOff);
  if (messaging::SignalStop::received() != 0) {
    std::cerr << "topogeo: stopped; " << session.summary() << '\n';
    return interrupted();
  }
  if (!session.trouble().empty()) throw std::runtime_error(session.trouble());
  std::cout << session.summary() << '\n';
  return service::kOk;
}

}  // namespace

void add_explore_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command = app.add_subcommand(
      "explore", "Send a mapping robot to every reachable place that it has not seen");
  auto options = std::make_shared<ExploreOptions>();
  command->add_option("--picture", options->picture, "draw map and path as .png or .svg at the end")
      ->type_name("FILE");
  command->add_option("--config", options->config, "configuration (YAML), for its explorer section")
      ->type_name("FILE");
  add_robot_options(*command, options->robot);
  command->footer(
      "Needs the services of a mapping robot, planner and navigator among them. Ctrl-C "
      "stops the robot; the map stays. Another program that replaces or cancels the goal ends "
      "the exploration.");
  command->callback([options, &exit_code] { exit_code = explore(*options); });
}

}  // namespace topogeo::cli
