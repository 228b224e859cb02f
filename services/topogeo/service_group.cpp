#include "service_group.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <string_view>

namespace topogeo::cli {
namespace {

using Words = std::vector<std::string>;

constexpr std::string_view kWorker = "ga_worker";
constexpr double kStopTime_s = 5.0;  // that services have to end after they are asked to

/// Flags that all services have.
Words common_arguments(const RunOptions& options, const std::string& partition) {
  Words words = {"--domain",    std::to_string(options.domain),
                 "--partition", partition,
                 "--robot-id",  options.job.robot_id};
  if (options.job.config) words.insert(words.end(), {"--config", options.job.config->string()});
  if (!options.profiles_file.empty()) {
    words.insert(words.end(), {"--profiles", options.profiles_file.string()});
  }
  return words;
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// What a map store keeps, or the map that it shows as it is.
Words store_arguments(const RunOptions& options) {
  if (options.goal && options.job.map) return {"--map", options.job.map->string()};
  Words words = {"--out", options.job.out.string(), "--title", source_name(options)};
  if (options.job.continued) {
    words.insert(words.end(), {"--continue", options.job.continued->string()});
  }
  return words;
}

/// What makes a localizer follow the robot in a stored map, or extend it.
Words map_arguments(const RunOptions& options) {
  Words words;
  if (options.job.continued) words = {"--continue", options.job.continued->string()};
  if (options.job.map) {
    words = {"--map", options.job.map->string(), "--csv",
             (options.job.out / "localization.csv").string()};
  }
  if (options.job.initial_pose) {
    words.push_back("--initial-pose=" + *options.job.initial_pose);
  }
  return words;
}

bool is_worker(const std::string& name) {
  return name.starts_with(kWorker);
}

}  // namespace

std::string source_name(const RunOptions& options) {
  if (options.simulation) return options.simulation->world.filename().string();
  return (options.devices.empty() ? options.job.log : options.devices).filename().string();
}

std::filesystem::path simulated_port(const RunOptions& options, const std::string& device) {
  return std::filesystem::absolute(options.job.out / (device + ".port"));
}

ServiceGroup::ServiceGroup(const RunOptions& options, const std::string& partition)
    : programs_(std::filesystem::read_symlink("/proc/self/exe").parent_path()),
      logs_(options.job.out / "logs") {
  std::filesystem::create_directories(logs_);
  const Words common = common_arguments(options, partition);
  start("map_store", "map_store", common + store_arguments(options));
  start("planner", "planner", common);
  if (options.goal || options.explore) start("navigator", "navigator", common);
  start(
      "localizer", "localizer",
      common +
          Words{"--wait-workers", std::to_string(options.wait_workers.value_or(options.workers))} +
          map_arguments(options));
  start("local_mapper", "local_mapper",
        options.devices.empty() ? common + Words{"--replay"} : common);
  for (std::uint32_t i = 1; i <= options.workers; ++i) {
    const std::string name = std::string(kWorker) + "_" + std::to_string(i);
    start(name, std::string(kWorker), common + Words{"--name", name, "--slots", "1"});
  }
  if (!options.record.empty()) start_recorder(options, partition);
  start_source(options, common);
  told_.assign(children_.size(), false);
}

void ServiceGroup::start_source(const RunOptions& options, const Words& common) {
  if (const auto& simulation = options.simulation) {
    start("simulator", "simulator",
          common + Words{"--world", simulation->world.string(), "--seed",
                         std::to_string(simulation->seed), "--odometry", simulation->odometry,
                         "--people", std::to_string(simulation->people), "--laser-port",
                         simulated_port(options, "laser").string(), "--base-port",
                         simulated_port(options, "base").string(), "--base-baud",
                         std::to_string(kSimulatedBaseBaud)});
  }
  const Words source = options.devices.empty()
                           ? Words{"--log", options.job.log.string(), "--rate", options.rate}
                           : Words{"--devices", options.devices.string()};
  // All of them have the first scan.
  const std::string readers = options.record.empty() ? "1" : "2";
  start("sensor_gateway", "sensor_gateway", common + source + Words{"--readers", readers});
}

void ServiceGroup::start_recorder(const RunOptions& options, const std::string& partition) {
  Words words = {"record",
                 "--out",
                 options.record.string(),
                 "--domain",
                 std::to_string(options.domain),
                 "--partition",
                 partition,
                 "--robot-id",
                 options.job.robot_id};
  if (!options.profiles_file.empty()) {
    words.insert(words.end(), {"--profiles", options.profiles_file.string()});
  }
  start("record", "topogeo", words);
}

void ServiceGroup::start(const std::string& name, const std::string& program,
                         const std::vector<std::string>& arguments) {
  children_.emplace_back(name, programs_ / program, arguments, logs_ / (name + ".log"));
}

std::optional<ServiceGroup::Death> ServiceGroup::next_death() {
  for (std::size_t i = 0; i < children_.size(); ++i) {
    if (told_[i]) continue;
    const std::optional<ChildExit>& exit = children_[i].poll();
    if (!exit) continue;
    told_[i] = true;
    std::string what = children_[i].name() + " " + describe(*exit);
    const std::string last = children_[i].last_line();
    what += last.empty() ? ", it had logged nothing" : "; last line of its log: " + last;
    return Death{children_[i].name(), what, is_worker(children_[i].name()), exit->clean()};
  }
  return std::nullopt;
}

void ServiceGroup::send_signal(int signal_number, const std::string& name) {
  for (ChildProcess& child : children_) {
    if (name.empty() || child.name() == name) child.send_signal(signal_number);
  }
}

std::vector<std::string> ServiceGroup::running() {
  std::vector<std::string> names;
  for (ChildProcess& child : children_) {
    if (!child.poll()) names.push_back(child.name());
  }
  return names;
}

std::vector<support::StageTime> ServiceGroup::wait() {
  std::vector<support::StageTime> times;
  for (ChildProcess& child : children_) {
    child.wait();
    if (const auto& exit = child.poll()) {
      times.push_back({child.name(), exit->wall_s, exit->cpu_s});
    }
  }
  constexpr std::array<std::string_view, 8> kOrder = {"simulator", "sensor_gateway", "local_mapper",
                                                      "localizer", kWorker,          "map_store",
                                                      "planner",   "navigator"};
  const auto place = [&](const support::StageTime& time) {
    return std::find_if(kOrder.begin(), kOrder.end(),
                        [&](std::string_view name) { return time.stage.starts_with(name); });
  };
  std::stable_sort(times.begin(), times.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return times;
}

void stop(ServiceGroup& services, messaging::EventLoop& loop, bool gateway_first,
          const std::function<void(const std::string&)>& say) {
  const double end_s = support::monotonic_s() + kStopTime_s;
  const auto wait_while = [&](const auto& running) {
    while (running() && support::monotonic_s() < end_s) loop.run_for(std::chrono::milliseconds(20));
  };
  if (gateway_first) {
    // Alone and first: a writer whose reader goes while samples are on their way to it can lock up
    // inside Fast DDS 2.9.1 (matched_reader_remove against the flow controller's thread).
    services.send_signal(SIGTERM, "sensor_gateway");
    wait_while([&] {
      const std::vector<std::string> names = services.running();
      return std::find(names.begin(), names.end(), "sensor_gateway") != names.end();
    });
  }
  services.send_signal(SIGTERM);
  wait_while([&] { return !services.running().empty(); });
  for (const std::string& name : services.running()) {
    say(name + " did not stop in time and is killed");
  }
  services.send_signal(SIGKILL);
  loop.run_for(std::chrono::milliseconds(20));
}

}  // namespace topogeo::cli
