// Publishes the scans and odometry of a robot, from its devices or from a log.
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/log_feed.hpp"
#include "topogeo/service/replay_rate.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/process_priority.hpp"

#include "device_config.hpp"
#include "device_gateway.hpp"
#include "log_gateway.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct Options {
  sensor_gateway::GatewayOptions replay;
  std::filesystem::path devices;
  std::optional<std::string> laser_port;
  std::optional<std::string> base_port;
  std::filesystem::path memory;
};

struct OpenLog {
  service::LogFeed feed;
  std::uint64_t scans_total;
};

OpenLog open_log(const sensor_gateway::GatewayOptions& replay, const pipeline::Config& config) {
  try {
    recording::LogReader reader(replay.log, config.log, replay.topics);
    const std::uint64_t scans = reader.scan_count();
    return {service::LogFeed(std::move(reader), config), scans};
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

sensor_gateway::DeviceConfig load_devices(const Options& options) {
  try {
    return sensor_gateway::load_devices(options.devices, options.laser_port, options.base_port);
  } catch (const std::runtime_error& error) {
    throw service::UsageError(error.what());
  }
}

void add_options_to(command_line::Command& app, Options& options) {
  command_line::Command* source =
      app.add_option_group("source", "where scans and odometry come from");
  command_line::Option* log =
      source->add_option("--log", options.replay.log, recording::kLogFormats);
  command_line::Option* devices =
      source->add_option("--devices", options.devices,
                         "ports and kinds of the devices (YAML), see `topogeo config --devices`");
  source->require_option(1);
  app.add_option_function(
         "--rate",
         [&](const std::string& text) { options.replay.rate = service::parse_rate(text); },
         "replay rate of a log: realtime, lossless (as fast as its readers) or a factor of real "
         "time")
      ->needs(log)
      ->default_str("lossless");
  app.add_option_function(
         "--sweep",
         [&topics = options.replay.topics](const std::string& order) {
           topics.sweep = ros::sweep_order(order);
         },
         "correction of motion during a scan of a ROS recording, see topogeo map --help")
      ->check(command_line::one_of({"none", "forward", "backward"}));
  app.add_option("--scan-topic", options.replay.topics.scan,
                 "topic of the laser scans in a ROS recording")
      ->needs(log)
      ->type_name("TOPIC");
  app.add_option("--odometry-topic", options.replay.topics.odometry,
                 "topic of the odometry or transforms in a ROS recording")
      ->needs(log)
      ->type_name("TOPIC");
  app.add_option("--scan-delay", options.replay.topics.scan_delay_s,
                 "time by which the stamps of scans in a ROS recording are late, s")
      ->needs(log)
      ->check(command_line::range(-10.0, 10.0))
      ->type_name("S");
  app.add_flag("--upside-down", options.replay.topics.upside_down,
               "the laser of the log hangs upside down");
  app.add_option("--readers", options.replay.readers,
                 "number of scan readers to wait for; 0: do not wait")
      ->check(command_line::range(0, 100))
      ->default_str("1 for a log, 0 for devices");
  app.add_option("--odometry-readers", options.replay.odometry_readers,
                 "number of odometry readers to wait for")
      ->check(command_line::range(0, 100))
      ->needs(log)
      ->capture_default_str();
  app.add_flag("--exit-at-end", options.replay.exit_at_end, "exit at the end of the log")
      ->needs(log);
  app.add_option("--laser-port", options.laser_port, "serial port of the laser; overrides the file")
      ->needs(devices);
  app.add_option("--base-port", options.base_port, "serial port of the base; overrides the file")
      ->needs(devices);
  app.add_option("--memory", options.memory,
                 "file with the state of the odometry, from which a restarted gateway resumes; "
                 "best in /run, because it is written constantly. FILE.laser has the baud rate of "
                 "the laser, FILE.stops a halt or an emergency stop until the reset")
      ->needs(devices)
      ->type_name("FILE");
}

void replay(const service::Setup& setup, sensor_gateway::GatewayOptions options) {
  options.topics.T_robot_laser = setup.config.config.local_mapper.T_robot_laser;
  options.topics.odometry_use = service::odometry_use(setup.config.config);
  OpenLog log = open_log(options, setup.config.config);
  service::Service service(setup);
  const sensor_gateway::LogGateway gateway(service, options, std::move(log.feed), log.scans_total);
  service.run();
}

void work_with_devices(const service::Setup& setup, const Options& options) {
  const sensor_gateway::DeviceConfig config = load_devices(options);
  // A base stops by itself when its gateway has to wait for a CPU.
  static_cast<void>(support::go_first());
  service::Service service(setup);
  sensor_gateway::DeviceGateway gateway(service, config, options.replay.readers.value_or(0),
                                        options.memory);
  service.run();
  gateway.finish();
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  return service::run_service(
      argc, argv, "sensor_gateway",
      "Publishes the scans and odometry of a robot's devices, or those of a log, and drives its "
      "base.",
      [&](command_line::Command& app) { add_options_to(app, options); },
      [&](const service::Setup& setup) {
        if (options.devices.empty()) {
          replay(setup, options.replay);
        } else {
          work_with_devices(setup, options);
        }
      });
}
