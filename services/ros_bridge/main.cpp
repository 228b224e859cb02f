// Connects a robot that speaks ROS 2 to the services of topogeo; needs no part of ROS.
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/service/own_partition.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

#include "ros_bridge_service.hpp"
#include "settings.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

struct BridgeOptions {
  ros_bridge::SettingOptions settings;
  std::optional<std::uint32_t> ros_domain;
  std::string map_robot;
  std::optional<ros_bridge::Direction> sensors;
  bool clock = false;
  bool replay = false;
  bool ros_arguments = false;
  bool print_settings = false;
  std::optional<double> show_mounting_s;
};

/// Parsed like ROS does: 0x10 is 16.
std::uint32_t domain_of_environment(std::uint32_t otherwise) {
  constexpr unsigned long kLargestDomain = 232;
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return otherwise;
  char* end = nullptr;
  const unsigned long domain = std::strtoul(text, &end, 0);
  if (*end != '\0' || domain > kLargestDomain) {
    throw service::UsageError(std::string("ROS_DOMAIN_ID: expected 0 to 232, got '") + text + "'");
  }
  return static_cast<std::uint32_t>(domain);
}

void add_bridge_options(command_line::Command& app, BridgeOptions& options) {
  app.add_option(
         "--ros", options.settings.file,
         "settings (YAML): names, frames, directions and quality of service; see --print-settings")
      ->type_name("FILE");
  app.add_option("-r,--remap", options.settings.remaps,
                 "rename a ROS topic, with the syntax of ROS: /scan:=/front/scan; __ns:=/robot1")
      ->allow_extra_args(false)
      ->type_name("FROM:=TO");
  app.add_option("--namespace", options.settings.ros_namespace,
                 "namespace of the ROS topics whose names do not begin with '/'")
      ->type_name("NAME");
  app.add_flag("--print-settings", options.print_settings,
               "print the settings, by default or of --ros, with every key documented, and exit");
  app.add_flag("--ros-args", options.ros_arguments,
               "ignored, so that arguments of ROS can be pasted");
  app.add_option("--ros-domain", options.ros_domain,
                 "DDS domain of the ROS nodes (default: ROS_DOMAIN_ID, else --domain)")
      ->check(command_line::range(0U, 232U));
  app.add_option_function(
         "--sensors",
         [&options](const std::string& direction) {
           options.sensors = direction == "in"    ? ros_bridge::Direction::kIn
                             : direction == "out" ? ros_bridge::Direction::kOut
                                                  : ros_bridge::Direction::kOff;
         },
         "overrides directions.sensors; out also disables velocities to ROS")
      ->check(command_line::one_of({"in", "out", "off"}));
  app.add_flag("--clock", options.clock, "overrides directions.clock with true");
  app.add_flag("--replay", options.replay, "with sensors out: the scans come from a log");
  app.add_option("--show-mounting", options.show_mounting_s,
                 "print the mounting of the laser by the transforms of ROS, in the form of "
                 "--laser, and exit; longest wait for a scan")
      ->check(command_line::range(0.0, 3600.0))
      ->type_name("SECONDS");
  service::add_map_option(app, options.map_robot);
}

ros_bridge::Settings load(const BridgeOptions& options) {
  try {
    ros_bridge::Settings settings = ros_bridge::load_settings(options.settings);
    ros_bridge::Directions& directions = settings.directions;
    if (options.sensors) {
      directions.sensors = *options.sensors;
      // With sensors out, the base is ours.
      const bool ours = directions.sensors == ros_bridge::Direction::kOut;
      if (ours && directions.velocity == ros_bridge::Direction::kOut) {
        directions.velocity = ros_bridge::Direction::kOff;
      }
    }
    directions.clock |= options.clock;
    return settings;
  } catch (const std::runtime_error& error) {
    throw service::UsageError(error.what());
  }
}

void print_settings(const BridgeOptions& options) {
  ros_bridge::Settings settings;
  const support::ConfigSchema schema = describe(settings);
  try {
    if (options.settings.file) support::load_yaml_file(*options.settings.file, schema);
  } catch (const std::runtime_error& error) {
    throw service::UsageError(error.what());
  }
  support::write_yaml(schema, std::cout);
}

/// Runs in a partition of its own, unseen by other services, and sends nothing to ROS.
void show_mounting(service::Setup setup, ros_bridge::Settings settings, std::uint32_t domain,
                   double wait_s) {
  setup.options.partition = service::own_partition("show-mounting");
  settings.directions = {};
  service::Service service(setup);
  const ros_bridge::RosBridgeService bridge(service, settings, domain, false);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait_s);
  while (!bridge.mounting() && std::chrono::steady_clock::now() < end) {
    if (service.loop().run_for(std::chrono::milliseconds(20))) return;
  }
  const auto mounting = bridge.mounting();
  if (!mounting) {
    throw std::runtime_error(fmt::format(
        "no scan within {:.0f} s whose frame has a transform to the frame of the robot", wait_s));
  }
  std::cout << pipeline::mounting_argument(mounting->T_robot_laser) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  BridgeOptions options;
  return service::run_service(
      argc, argv, "ros_bridge",
      "Connects a ROS 2 robot: receives its scans, odometry, transforms and goals, publishes map, "
      "pose, route and velocities.",
      [&](command_line::Command& app) { add_bridge_options(app, options); },
      [&](const service::Setup& setup) {
        if (options.print_settings) {
          print_settings(options);
          return;
        }
        const ros_bridge::Settings settings = load(options);
        const std::uint32_t domain =
            options.ros_domain ? *options.ros_domain : domain_of_environment(setup.options.domain);
        if (options.show_mounting_s) {
          show_mounting(setup, settings, domain, *options.show_mounting_s);
          return;
        }
        service::Service service(service::with_map_of(setup, options.map_robot));
        ros_bridge::RosBridgeService bridge(service, settings, domain, options.replay);
        service.run();
        bridge.finish();
      });
}
