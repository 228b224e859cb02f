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

enum ExitCode : int {
  kOk = 0,
  kFailure = 1,   ///< something broke at run time
  kUsage = 2,     ///< a flag or the configuration is wrong
  kBadInput = 3,  ///< a given log, directory or database cannot be used
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
  std::string partition = messaging::kDefaultPartition;  ///< different partitions never meet
  std::string robot_id = "robot";                        ///< 1 to 32 bytes
  std::vector<std::string> other_robots;                 ///< robots that share the map of robot_id
  std::string map_robot;                                 ///< whose map is used; empty: robot_id's
  std::optional<std::filesystem::path> config;           ///< YAML; none: the defaults
  std::optional<std::string> laser;                      ///< see pipeline::parse_mounting
  std::filesystem::path profiles_file;                   ///< QoS profiles; empty: built in
  std::string log_level = "info";
  std::optional<std::uint32_t> metrics_port;  ///< overrides the configured port; 0: any free one
  std::optional<std::string> metrics_address;
};

/// Adds --domain, a DDS domain from 0 to 232, with TOPOGEO_DOMAIN as default.
void add_domain_option(command_line::Command& app, std::uint32_t& domain);

/// Adds the flags of `options` to `app`; `options` must outlive it.
void add_service_options(command_line::Command& app, ServiceOptions& options);

/// Joins the domain under the name "<robot>/<service>". With security, its keys must name the
/// robots of the options; with `any_robot`, it works for all robots that its keys name. Throws like
/// messaging::Participant.
messaging::Participant make_participant(const ServiceOptions& options, const std::string& service,
                                        bool any_robot);

/// Identity, options and configuration with which a service starts.
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
/// The setup with the map of that robot; empty: its own.
Setup with_map_of(Setup setup, std::string robot);
/// The setup with these robots beside its own. Throws UsageError when a name is unusable or
/// repeated.
Setup with_robots(Setup setup, std::vector<std::string> robots);

/// The main function of a service. Parses the command line (`add_options` adds the service's own
/// flags), sets up logging, loads the configuration and calls `body`, which returns when the
/// service should end. An exception from any step becomes one line on stderr and an exit code.
int run_service(int argc, const char* const* argv, const std::string& name,
                const std::string& description,
                const std::function<void(command_line::Command&)>& add_options,
                const std::function<void(const Setup&)>& body, const ServiceOptions& defaults = {});

}  // namespace topogeo::service
