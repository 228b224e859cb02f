// topogeo config: every key of the configuration, documented, as a file to start from.
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/service/service_options.hpp"

#include "commands.hpp"
#include "device_config.hpp"

namespace topogeo::cli {
namespace {

void print_config(const support::ConfigSchema& schema,
                  const std::optional<std::filesystem::path>& file) {
  try {
    if (file) support::load_yaml_file(*file, schema);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  support::write_yaml(schema, std::cout);
}

void print_config(const std::optional<std::filesystem::path>& file, bool devices) {
  if (devices) {
    sensor_gateway::DeviceFile values;
    print_config(describe(values), file);
  } else {
    pipeline::Config values;
    print_config(pipeline::describe(values), file);
  }
}

}  // namespace

void add_config_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("config", "Print the configuration with every key documented (YAML)");
  auto file = std::make_shared<std::optional<std::filesystem::path>>();
  command->add_option("--config", *file, "take the values of this file instead of the defaults")
      ->type_name("FILE");
  auto devices = std::make_shared<bool>(false);
  command->add_flag("--devices", *devices,
                    "the file of a robot's devices instead, for --devices of other commands");
  command->callback([file, devices, &exit_code] {
    print_config(*file, *devices);
    exit_code = service::kOk;
  });
}

}  // namespace topogeo::cli
