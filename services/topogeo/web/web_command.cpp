// topogeo web: a page for a running robot; topogeo view: a page for a stored map.
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <unistd.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/temporary_folder.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "run/run_log.hpp"
#include "web/web_command_options.hpp"
#include "web/web_run.hpp"

namespace topogeo::cli {
namespace {

struct WebCommand {
  WebOptions web;
  std::uint32_t domain = 0;
  std::string partition = messaging::kAnyPartition;
  std::string robot_id = "robot";
  std::string map_of;
  std::optional<std::filesystem::path> config;
};

struct ViewCommand {
  std::filesystem::path map;
  WebOptions web;
  bool no_browser = false;
  std::uint32_t domain = 0;
};

/// Replaces this process by the program `web`.
[[noreturn]] void become_web_service(const WebCommand& command) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "web";
  std::vector<std::string> words = {
      "web",           "--domain",        std::to_string(command.domain),
      "--partition",   command.partition, "--robot-id",
      command.robot_id};
  if (!command.map_of.empty()) words.insert(words.end(), {"--map-of", command.map_of});
  if (command.config) words.insert(words.end(), {"--config", command.config->string()});
  for (const std::string& argument : web_arguments(command.web)) words.push_back(argument);
  if (command.web.token || command.web.token_file) export_token(command.web);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(program.c_str(), arguments.data());
  throw std::system_error(errno, std::generic_category(), program.string());
}

int view(const ViewCommand& command) {
  check_web_options(command.web);
  try {
    static_cast<void>(storage::read_map(command.map));
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  const support::TemporaryFolder logs("view");  // logs of the services
  RunOptions options;
  options.domain = command.domain;
  options.job.map = command.map;
  options.job.out = logs.path();
  options.web = command.web;
  return run_web(options, !command.no_browser);
}

}  // namespace

void add_web_command(command_line::Command& app, int&) {
  command_line::Command* web =
      app.add_subcommand("web", "Serve a page to watch, send, drive and correct a running robot");
  auto options = std::make_shared<WebCommand>();
  add_web_options(*web, options->web);
  service::add_domain_option(*web, options->domain);
  web->add_option("--partition", options->partition, "only services in this partition; *: all")
      ->capture_default_str();
  add_robot_option(*web, options->robot_id, "robot of the page");
  service::add_map_option(*web, options->map_of);
  add_config_option(*web, options->config);
  web->footer("Prints the link of the operator and that of spectators, who may only watch.");
  web->callback([options] { become_web_service(*options); });
}

void add_view_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("view", "Show a stored map in the browser, without a robot");
  auto options = std::make_shared<ViewCommand>();
  command->add_option("map", options->map, "map file: map.pb or map.sqlite")
      ->required()
      ->type_name("MAP");
  add_web_options(*command, options->web);
  command->add_flag("--no-browser", options->no_browser, "print the link, do not open a browser");
  service::add_domain_option(*command, options->domain);
  command->callback([options, &exit_code] { exit_code = view(*options); });
}

}  // namespace topogeo::cli
