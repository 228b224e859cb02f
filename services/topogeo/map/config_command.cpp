// topogeo config: every key of the configuration, documented, as a template file.
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

struct ConfigOptions {
  std::optional<std::filesystem::path> file;
  bool devices = false;
  bool markdown = false;
};

void print_config(const support::ConfigSchema& schema, const ConfigOptions& options) {
  try {
    if (options.file) support::load_yaml_file(*options.file, schema);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  if (options.markdown) {
    support::write_markdown(schema, std::cout);
  } else {
    support::write_yaml(schema, std::cout);
  }
}

void print_config(const ConfigOptions& options) {
  if (options.devices) {
    sensor_gateway::DeviceFile values;
    print_config(describe(values), options);
  } else {
    pipeline::Config values;
    print_config(pipeline::describe(values), options);
  }
}

}  // namespace

void add_config_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("config", "Print the configuration with every key documented (YAML)");
  auto options = std::make_shared<ConfigOptions>();
  command
      ->add_option("--config", options->file,
                   "take the values of this file instead of the defaults")
      ->type_name("FILE");
  command->add_flag("--devices", options->devices,
                    "print the device file instead, for --devices of other commands");
  command->add_flag("--markdown", options->markdown,
                    "tables of keys, defaults and ranges instead of YAML");
  command->callback([options, &exit_code] {
    print_config(*options);
    exit_code = service::kOk;
  });
}

}  // namespace topogeo::cli
