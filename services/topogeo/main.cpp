// The command line: maps logs, shows services, plans routes.
#include <exception>
#include <iostream>
#include <string>
#include <string_view>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/command_line/secret_arguments.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/service/web_access.hpp"
#include "topogeo/support/logging.hpp"
#include "topogeo/support/version.hpp"

#include "commands.hpp"
#include "common/installed_settings.hpp"

namespace {

int run(int argc, const char* const* argv) {
  using namespace topogeo;
  int exit_code = service::kOk;
  command_line::Command app(
      "Maps indoor places from laser scans and plans routes through them.\n"
      "\n"
      "Start here:\n"
      "  topogeo demo --out demo                 map a synthetic floor, compare it with the truth\n"
      "  topogeo check-log LOG                   content and faults of a log or recording\n"
      "  topogeo map LOG --out map               map it; map/map.png is the picture\n"
      "  topogeo view map                        look at the map in the browser\n"
      "  topogeo run --sim WORLD --out map       drive a simulated robot, all services at work\n",
      "topogeo");
  app.set_version_flag("--version", "topogeo " + std::string(support::kVersion));
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 failed, 2 wrong flag or configuration, 3 unusable input,\n"
      "130 stopped by Ctrl-C. `topogeo COMMAND --help` lists all options.");
  cli::add_run_command(app, exit_code);
  cli::add_map_command(app, exit_code);
  cli::add_localize_command(app, exit_code);
  cli::add_localizer_command(app, exit_code);
  cli::add_base_command(app, exit_code);
  cli::add_record_command(app, exit_code);
  cli::add_check_log_command(app, exit_code);
  cli::add_convert_command(app, exit_code);
  cli::add_demo_command(app, exit_code);
  cli::add_simulator_command(app, exit_code);
  cli::add_status_command(app, exit_code);
  cli::add_workers_command(app, exit_code);
  cli::add_top_command(app, exit_code);
  cli::add_devices_command(app, exit_code);
  cli::add_doctor_command(app, exit_code);
  cli::add_follow_command(app, exit_code);
  cli::add_goto_command(app, exit_code);
  cli::add_explore_command(app, exit_code);
  cli::add_web_command(app, exit_code);
  cli::add_view_command(app, exit_code);
  cli::add_places_command(app, exit_code);
  cli::add_draw_command(app, exit_code);
  cli::add_plan_command(app, exit_code);
  cli::add_simulate_route_command(app, exit_code);
  cli::add_dvl_command(app, exit_code);
  cli::add_match_command(app, exit_code);
  cli::add_reproduce_command(app, exit_code);
  cli::add_config_command(app, exit_code);
  cli::add_calibrate_laser_command(app, exit_code);
  cli::add_calibrate_odometry_command(app, exit_code);
  cli::add_compare_command(app, exit_code);
  cli::add_store_command(app, exit_code);
  app.group_subcommands("Maps", {"run", "map", "demo", "localize", "view", "store"});
  app.group_subcommands("Logs and recordings", {"check-log", "convert", "record", "compare",
                                                "calibrate-laser", "calibrate-odometry"});
  app.group_subcommands("A running robot",
                        {"devices", "status", "top", "workers", "doctor", "follow", "web", "goto",
                         "explore", "localizer", "base", "simulator", "draw"});
  app.group_subcommands("Places and routes", {"places", "plan", "simulate-route"});
  app.group_subcommands("How it works", {"config", "dvl", "match", "reproduce"});
  if (const auto exit_now = app.parse(argc, argv)) return *exit_now;
  return exit_code;
}

/// These services must not be mixed with those of the host.
bool has_services_of_its_own(std::string_view command) {
  return command == "run" || command == "demo" || command == "view";
}

}  // namespace

int main(int argc, char** argv) {
  using namespace topogeo;
  int code = service::kFailure;
  try {
    support::set_up_logging("topogeo", "warning");
    if (argc > 1 && !has_services_of_its_own(argv[1])) cli::take_installed_settings();
    const command_line::SecretArguments arguments(argc, argv, {service::kTokenOption});
    return run(arguments.count(), arguments.values());
  } catch (const service::UsageError& error) {
    std::cerr << "topogeo: " << error.what() << '\n';
    code = service::kUsage;
  } catch (const service::BadInputError& error) {
    std::cerr << "topogeo: " << error.what() << '\n';
    code = service::kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "topogeo: " << error.what() << '\n';
  }
  return code;
}
