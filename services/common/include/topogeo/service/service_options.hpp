// Command line, configuration and exit code of a service.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/pipeline/config.hpp"

namespace topogeo::service {

/// What the process gives back.
enum ExitCode : int {
  kOk = 0,
  kFailure = 1,   ///< something broke while it ran
  kUsage = 2,     ///< a flag or the configuration is wrong
  kBadInput = 3,  ///< a log, directory or database that it was given cannot be used
};

/// Ends the program with kUsage.
using UsageError = command_line::UsageError;

/// Ends the program with kBadInput.
class BadInputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Flags that every service has.
struct ServiceOptions {
  std::uint32_t domain = 0;                              ///< DDS domain, 0 to 232
  std::string partition = messaging::kDefaultPartition;  ///< runs of different ones never meet
  std::string robot_id = "robot";                        ///< 1 to 32 bytes
  std::vector<std::string> other_robots;                 ///< that share the map of robot_id
  std::string map_robot;                                 ///< whose map is used; empty: robot_id's
  std::optional<std::filesystem::path> config;           ///< YAML; none: the defaults
  std::optional<std::string> laser;                      ///< see pipeline::parse_mounting
  std::filesystem::path profiles_file;                   ///< QoS profiles; empty: built in
  std::string log_level = "info";
  std::optional<std::uint32_t> metrics_port;  ///< in place of the configured one; 0: any free one
  std::optional<std::string> metrics_address;
};

/// Adds --domain, a DDS domain from 0 to 232, whose default is that of TOPOGEO_DOMAIN.
void add_domain_option(command_line::Command& app, std::uint32_t& domain);

/// Adds the flags of `options` to `app`; `options` must outlive it.
void add_service_options(command_line::Command& app, ServiceOptions& options);

/// Joins the domain under the name "<robot>/<service>". With security its keys must name the robots
/// of the options; `any_robot`: it works for all that its keys name. Throws like
/// messaging::Participant.
messaging::Participant make_participant(const ServiceOptions& options, const std::string& service,
                                        bool any_robot);

/// What a service starts with.
struct Setup {
  std::string name;      ///< of the executable
  std::string instance;  ///< see messaging::ServiceIdentity
  ServiceOptions options;
  pipeline::LoadedConfig config;
};

/// Adds --with-robots, for services that keep one map of several robots.
void add_robots_option(command_line::Command& app, std::vector<std::string>& robots);
/// Adds --map-of, for services that use a map.
void add_map_option(command_line::Command& app, std::string& robot);
/// The setup with the map of that robot; empty: with its own.
Setup with_map_of(Setup setup, std::string robot);
/// The setup with these robots beside its own. Throws UsageError when one has no usable name or
/// stands there twice.
Setup with_robots(Setup setup, std::vector<std::string> robots);

/// The main function of a service. Parses the command line (`add_options` adds the service's own
/// flags), sets up logging, loads the configuration and calls `body`, which returns when the
/// service is to end. What it throws becomes one line on stderr and an exit code.
int run_service(int argc, const char* const* argv, const std::string& name,
                const std::string& description,
                const std::function<void(command_line::Command&)>& add_options,
                const std::function<void(const Setup&)>& body, const ServiceOptions& defaults = {});

}  // namespace topogeo::service
