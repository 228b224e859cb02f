#include "run/ros_run.hpp"

#include <stdexcept>

#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/supervision/child_process.hpp"

namespace topogeo::cli {

void add_ros_options(command_line::Command& app, RosOptions& options,
                     command_line::Option* needed) {
  const std::vector<command_line::Option*> added = {
      app.add_option("--ros-settings", options.settings,
                     "names, frames, directions and quality of service of the topics of ROS (YAML, "
                     "see topogeo-ros-bridge --print-settings)")
          ->type_name("FILE"),
      app.add_option("--remap", options.remaps,
                     "rename a ROS topic: /scan:=/front/scan; __ns:=/robot1")
          ->allow_extra_args(false)
          ->type_name("FROM:=TO"),
      app.add_option("--ros-domain", options.domain,
                     "DDS domain of the ROS nodes (default: ROS_DOMAIN_ID, else --domain)")
          ->check(command_line::range(0U, 232U)),
      app.add_option("--ros-wait", options.wait_s,
                     "with --ros alone: how long to wait for the first scan and its transforms")
          ->check(command_line::range(0.0, 3600.0))
          ->capture_default_str()};
  for (command_line::Option* option : added) option->needs(needed);
}

std::vector<std::string> ros_arguments(const RosOptions& options) {
  std::vector<std::string> arguments;
  if (!options.settings.empty()) arguments = {"--ros", options.settings.string()};
  for (const std::string& remap : options.remaps) {
    arguments.insert(arguments.end(), {"--remap", remap});
  }
  if (options.domain) {
    arguments.insert(arguments.end(), {"--ros-domain", std::to_string(*options.domain)});
  }
  return arguments;
}

geometry::Pose2 mounting_of_ros(const RosOptions& options, const std::vector<std::string>& common,
                                const std::filesystem::path& log_file) {
  std::filesystem::create_directories(log_file.parent_path());
  std::vector<std::string> arguments = common;
  const std::vector<std::string> own = ros_arguments(options);
  arguments.insert(arguments.end(), own.begin(), own.end());
  arguments.insert(arguments.end(), {"--show-mounting", std::to_string(options.wait_s)});
  supervision::ChildProcess bridge(
      "ros_bridge", std::filesystem::read_symlink("/proc/self/exe").parent_path() / "ros_bridge",
      arguments, log_file);
  bridge.wait();
  const auto& end = bridge.poll();
  if (!end || !end->clean()) {
    throw std::runtime_error("ROS: " + bridge.last_line() + "; its log: " + log_file.string());
  }
  return pipeline::parse_mounting(bridge.last_line());
}

}  // namespace topogeo::cli
