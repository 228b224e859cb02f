#include "topogeo/service/service_options.hpp"

#include <charconv>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <set>
#include <string_view>
#include <utility>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/support/logging.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::service {

namespace {

constexpr std::uint32_t kLargestDomain = 232;  // of DDS over UDP: gives the ports
constexpr std::size_t kLongestRobotId = 32;    // idl

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Containers are configured by their environment; an empty variable is ignored.
void take_environment(pipeline::MetricsConfig& metrics) {
  constexpr std::uint32_t kLargestFirstPort = 65000;  // limit of `metrics.port`
  if (const std::string_view text = environment("TOPOGEO_METRICS_PORT"); !text.empty()) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), metrics.port);
    if (error != std::errc() || end != text.data() + text.size() ||
        metrics.port > kLargestFirstPort) {
      throw UsageError("TOPOGEO_METRICS_PORT: expected a port from 0 to 65000, got '" +
                       std::string(text) + "'");
    }
  }
  const std::string_view address = environment("TOPOGEO_METRICS_ADDRESS");
  if (!address.empty()) metrics.address = address;
}

/// The fingerprint stays that of the file: search workers elsewhere have only the file.
pipeline::LoadedConfig load(const ServiceOptions& options) {
  try {
    pipeline::LoadedConfig loaded = pipeline::load_config(options.config);
    if (options.laser)
      pipeline::mount_laser(loaded.config, pipeline::parse_mounting(*options.laser));
    take_environment(loaded.config.metrics);
    return loaded;
  } catch (const std::exception& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

void add_domain_option(command_line::Command& app, std::uint32_t& domain) {
  app.add_option("--domain", domain, "DDS domain")
      ->check(command_line::range(std::uint32_t{0}, kLargestDomain))
      ->environment("TOPOGEO_DOMAIN")
      ->capture_default_str();
}

void add_service_options(command_line::Command& app, ServiceOptions& options) {
  add_domain_option(app, options.domain);
  app.add_option("--partition", options.partition,
                 "DDS partition: only services of the same one connect, * connects to all")
      ->capture_default_str();
  app.add_option("--robot,--robot-id", options.robot_id, "name of the robot, up to 32 bytes")
      ->environment("TOPOGEO_ROBOT")
      ->check([](const std::string& id) {
        return id.empty() || id.size() > kLongestRobotId ? "expected 1 to 32 bytes" : "";
      })
      ->capture_default_str();
  app.add_option("--config", options.config, "configuration file (YAML)");
  app.add_option("--laser", options.laser,
                 "mounting of the laser, m and rad; overrides the configured one")
      ->type_name("X,Y,YAW");
  app.add_option("--profiles", options.profiles_file,
                 "file of QoS profiles; replaces the built-in ones");
  constexpr std::uint32_t kLargestPort = 65535;
  app.add_option("--metrics-port", options.metrics_port,
                 "HTTP port that serves metrics to Prometheus, 0: any free one; default: "
                 "TOPOGEO_METRICS_PORT of the environment, else `metrics.port` of the "
                 "configuration, else none")
      ->check(command_line::range(0U, kLargestPort))
      ->type_name("PORT");
  app.add_option("--metrics-address", options.metrics_address,
                 "listen address of the metrics (default: 127.0.0.1; others have neither password "
                 "nor encryption)")
      ->type_name("ADDRESS");
  app.add_option("--log-level", options.log_level,
                 "log messages of this severity and above to stderr")
      ->check(command_line::one_of({"trace", "debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
}

void add_robots_option(command_line::Command& app, std::vector<std::string>& robots) {
  app.add_option("--with-robots", robots,
                 "other robots that map the same floor into the same map, separated by commas; the "
                 "map is that of --robot")
      ->delimiter(',')
      ->type_name("ROBOT,...");
}

void add_map_option(command_line::Command& app, std::string& robot) {
  app.add_option("--map-of", robot,
                 "robot whose map is used, where several robots share one; default: --robot")
      ->type_name("ROBOT");
}

Setup with_map_of(Setup setup, std::string robot) {
  setup.options.map_robot = std::move(robot);
  return setup;
}

Setup with_robots(Setup setup, std::vector<std::string> robots) {
  std::set<std::string> all{setup.options.robot_id};
  for (const std::string& robot : robots) {
    if (robot.empty() || robot.size() > kLongestRobotId) {
      throw UsageError("--with-robots: expected names of 1 to 32 bytes, got '" + robot + "'");
    }
    if (!all.insert(robot).second) {
      throw UsageError("--with-robots: expected each robot once, got '" + robot + "' again");
    }
  }
  setup.options.other_robots = std::move(robots);
  return setup;
}

messaging::Participant make_participant(const ServiceOptions& options, const std::string& service,
                                        bool any_robot) {
  messaging::ParticipantOptions participant;
  participant.domain = options.domain;
  participant.partition = options.partition;
  participant.name = options.robot_id + "/" + service;
  participant.profiles_file = options.profiles_file;
  participant.identity = service;
  if (!any_robot) {
    participant.robots = options.other_robots;
    participant.robots.push_back(options.robot_id);
    if (!options.map_robot.empty()) participant.robots.push_back(options.map_robot);
  }
  return messaging::Participant(participant);
}

int run_service(int argc, const char* const* argv, const std::string& name,
                const std::string& description,
                const std::function<void(command_line::Command&)>& add_options,
                const std::function<void(const Setup&)>& body, const ServiceOptions& defaults) {
  try {
    Setup setup;
    setup.name = name;
    setup.options = defaults;
    command_line::Command app(description, name);
    app.set_version_flag("--version", name + " " + std::string(support::kVersion));
    add_service_options(app, setup.options);
    if (add_options) add_options(app);
    if (const auto exit_code = app.parse(argc, argv)) return *exit_code;
    support::set_up_logging(name, setup.options.log_level);
    setup.config = load(setup.options);
    body(setup);
    return kOk;
  } catch (const UsageError& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return kUsage;
  } catch (const BadInputError& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return kBadInput;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return kFailure;
  }
}

}  // namespace topogeo::service
