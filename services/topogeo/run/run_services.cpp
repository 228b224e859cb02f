#include "run/run_services.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

using supervision::Importance;
using supervision::ProcessGroup;
using supervision::Restart;
using Arguments = std::vector<std::string>;

constexpr std::string_view kWorker = "ga_worker";
constexpr const char* kGateway = "sensor_gateway";
constexpr const char* kRosBridge = "ros_bridge";

Arguments operator+(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// The laser mounting, unless the configuration gives it.
Arguments laser_argument(const RunOptions& options) {
  if (!options.laser) return {};
  return {"--laser=" + pipeline::mounting_argument(*options.laser)};
}

/// Outputs of a map store, or the finished map that it shows.
Arguments store_arguments(const RunOptions& options) {
  if ((options.goal || options.web) && options.job.map) return {"--map", options.job.map->string()};
  Arguments arguments = {"--out", options.job.out.string(), "--new", "--title",
                         source_name(options)};
  if (options.job.continued) {
    arguments.insert(arguments.end(), {"--continue", options.job.continued->string()});
  }
  if (const auto& floor = options.floor) {
    arguments.insert(arguments.end(), {"--drawing", floor->world.string(), "--zones",
                                       floor->zones.string(), "--drawing-pose=" + floor->pose});
  }
  return arguments;
}

/// Flags that make a localizer follow the robot in a stored map, or extend it.
Arguments map_arguments(const RunOptions& options) {
  Arguments arguments;
  if (options.job.continued) arguments = {"--continue", options.job.continued->string()};
  if (options.job.map) {
    arguments = {"--map", options.job.map->string(), "--csv",
                 (options.job.out / "localization.csv").string()};
  }
  if (options.job.initial_pose) {
    arguments.push_back("--initial-pose=" + *options.job.initial_pose);
  }
  return arguments;
}

/// Makes a service save the state for its restart, if there is a place for it.
Arguments memory_argument(const std::string& partition, const std::string& what) {
  const std::filesystem::path memory = memory_of_run(partition, what);
  if (!std::filesystem::is_directory(memory.parent_path())) return {};
  return {"--memory", memory.string()};
}

/// Starts the devices, the log or the ROS robot, and a simulator if there are no real devices.
void start_source(ProcessGroup& processes, const RunOptions& options, const std::string& partition,
                  const Arguments& common) {
  if (from_ros(options)) {
    processes.start(kRosBridge, kRosBridge, common + ros_arguments(*options.ros),
                    Importance::kNeeded, Restart::kWhenItDies);
    return;
  }
  if (const auto& simulation = options.simulation) {
    const Arguments sonars =
        simulation->no_laser ? Arguments{"--sonar-noise", "macondo"} : Arguments{};
    processes.start(
        "simulator", "simulator",
        common + sonars +
            Arguments{"--world", simulation->world.string(), "--seed",
                      std::to_string(simulation->seed), "--laser-model", simulation->laser_model,
                      "--base-model", simulation->base_model, "--odometry", simulation->odometry,
                      "--people", std::to_string(simulation->people), "--laser-port",
                      simulated_port(options, "laser").string(), "--base-port",
                      simulated_port(options, "base").string(), "--base-baud",
                      std::to_string(kSimulatedBaseBaud)});
  }
  Arguments source = {"--log", options.job.log.string(), "--rate", options.rate};
  const recording::TopicChoice& topics = options.job.topics;
  if (topics.sweep != ros::SweepOrder::kNone) {
    const bool forward = topics.sweep == ros::SweepOrder::kForward;
    source.insert(source.end(), {"--sweep", forward ? "forward" : "backward"});
  }
  if (topics.scan) source.insert(source.end(), {"--scan-topic", *topics.scan});
  if (topics.upside_down) source.emplace_back("--upside-down");
  if (topics.scan_delay_s) {
    source.push_back(fmt::format("--scan-delay={}", *topics.scan_delay_s));
  }
  if (topics.odometry) source.insert(source.end(), {"--odometry-topic", *topics.odometry});
  if (!options.devices.empty()) {
    source = {"--devices", options.devices.string()};
    source = source + memory_argument(partition, "odometry");
  }
  // Each of these readers gets the first scan.
  const int readers = readers_of_scans(options, !options.record.empty());
  processes.start(kGateway, kGateway,
                  common + source + Arguments{"--readers", std::to_string(readers)},
                  Importance::kNeeded, Restart::kWhenItDies);
}

/// Starts the bridge beside the source of the scans, which it passes on to ROS.
void start_bridge(ProcessGroup& processes, const RunOptions& options, const Arguments& common) {
  Arguments arguments = common + ros_arguments(*options.ros) + Arguments{"--sensors", "out"};
  if (options.devices.empty()) arguments = arguments + Arguments{"--replay", "--clock"};
  processes.start(kRosBridge, kRosBridge, arguments, Importance::kNeeded,
                  options.devices.empty() ? Restart::kNever : Restart::kWhenItDies);
}

void start_recorder(ProcessGroup& processes, const RunOptions& options,
                    const std::string& partition) {
  Arguments arguments = {"record",
                         "--out",
                         options.record.string(),
                         "--domain",
                         std::to_string(options.domain),
                         "--partition",
                         partition,
                         "--robot-id",
                         options.job.robot_id};
  if (!options.profiles_file.empty()) {
    arguments.insert(arguments.end(), {"--profiles", options.profiles_file.string()});
  }
  processes.start(kRecorder, "topogeo", arguments + laser_argument(options),
                  Importance::kMayFinish);
}

}  // namespace

bool from_ros(const RunOptions& options) {
  return options.ros && options.job.log.empty() && options.devices.empty();
}

// The page of a log must be counted: it could otherwise be mistaken for the mapper and miss scans.
int readers_of_scans(const RunOptions& options, bool recorder) {
  const bool maps = !options.simulation || !options.simulation->no_laser;
  const bool page_of_log = options.web && !options.job.log.empty();
  return (maps ? 1 : 0) + (recorder && maps ? 1 : 0) + (options.ros ? 1 : 0) +
         (page_of_log ? 1 : 0);
}

std::string scan_source(const RunOptions& options) {
  return from_ros(options) ? kRosBridge : kGateway;
}

Arguments common_arguments(const RunOptions& options, const std::string& partition) {
  Arguments arguments = {"--domain",    std::to_string(options.domain),
                         "--partition", partition,
                         "--robot-id",  options.job.robot_id};
  if (options.job.config)
    arguments.insert(arguments.end(), {"--config", options.job.config->string()});
  if (!options.profiles_file.empty()) {
    arguments.insert(arguments.end(), {"--profiles", options.profiles_file.string()});
  }
  return arguments + laser_argument(options);
}

std::string source_name(const RunOptions& options) {
  if (from_ros(options)) return "ROS";
  if (options.simulation) return options.simulation->world.filename().string();
  return (options.devices.empty() ? options.job.log : options.devices).filename().string();
}

std::filesystem::path memory_of_run(const std::string& partition, const std::string& what) {
  return "/dev/shm/topogeo-" + partition + "." + what;
}

std::vector<std::filesystem::path> memories_of_run(const std::string& partition) {
  const std::filesystem::path prefix = memory_of_run(partition, "");
  std::vector<std::filesystem::path> paths;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(prefix.parent_path(), ignored)) {
    if (entry.path().filename().string().starts_with(prefix.filename().string())) {
      paths.push_back(entry.path());
    }
  }
  return paths;
}

std::filesystem::path simulated_port(const RunOptions& options, const std::string& device) {
  return std::filesystem::absolute(options.job.out / (device + ".port"));
}

void start_services(ProcessGroup& processes, const RunOptions& options,
                    const std::string& partition) {
  const Arguments common = common_arguments(options, partition);
  const auto start = [&processes](const std::string& service, const Arguments& arguments) {
    processes.start(service, service, arguments, Importance::kNeeded, Restart::kWhenItDies);
  };
  start("map_store", common + store_arguments(options));
  processes.leave_out_at_restart("map_store", "--new");
  if (options.web) {
    export_token(*options.web);
    const std::filesystem::path log = options.job.out / "logs" / "web.log";
    start("web", common + web_arguments(*options.web) +
                     Arguments{"--link-file", link_file_beside(log).string(), "--audit-log",
                               (options.job.out / "logs" / "orders.jsonl").string()} +
                     memory_argument(partition, kWebMemory));
  }
  if (options.ros && !from_ros(options)) start_bridge(processes, options, common);
  if (options.job.log.empty() && options.devices.empty() && !options.ros) return;  // map only
  start("planner", common);
  // A robot of a log cannot be given a goal.
  const bool replay = !options.job.log.empty();
  if (options.goal || options.explore || (options.web && !replay)) {
    start("navigator", common + memory_argument(partition, "goal"));
  }
  // Without a laser there is nothing to match, and the navigator localizes the robot.
  if (options.simulation && options.simulation->no_laser) {
    start_source(processes, options, partition, common);
    return;
  }
  const std::uint32_t wait_workers = options.wait_workers.value_or(options.workers);
  const Arguments source = replay ? Arguments{"--replay"} : Arguments{};
  const Arguments memory =
      options.job.map && !replay ? memory_argument(partition, "pose") : Arguments{};
  start("localizer", common + source + Arguments{"--wait-workers", std::to_string(wait_workers)} +
                         map_arguments(options) + memory);
  start("local_mapper", common + source);
  for (std::uint32_t i = 1; i <= options.workers; ++i) {
    const std::string name = std::string(kWorker) + "_" + std::to_string(i);
    processes.start(name, std::string(kWorker), common + Arguments{"--name", name, "--slots", "1"},
                    Importance::kExpendable, Restart::kWhenItDies);
  }
  if (!options.record.empty()) start_recorder(processes, options, partition);
  start_source(processes, options, partition, common);
}

std::vector<support::StageTime> by_stage(std::vector<support::StageTime> times) {
  constexpr std::array<std::string_view, 10> kOrder = {
      "simulator", kGateway,    kRosBridge, "local_mapper", "localizer",
      kWorker,     "map_store", "planner",  "navigator",    "web"};
  const auto place = [&](const support::StageTime& time) {
    return std::find_if(kOrder.begin(), kOrder.end(),
                        [&](std::string_view name) { return time.stage.starts_with(name); });
  };
  std::stable_sort(times.begin(), times.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return times;
}

}  // namespace topogeo::cli
