// The services of one run as child processes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "child_process.hpp"
#include "goal_session.hpp"
#include "job.hpp"

namespace topogeo::cli {

/// A world with a robot in place of real devices.
struct SimulationOptions {
  std::filesystem::path world;  ///< file
  std::uint64_t seed = 1;
  std::uint32_t laser_baud = 500'000;
  std::string odometry = "mild";  ///< see `simulator --help`
  double speed_m_per_s = 0.9;
  std::uint32_t people = 0;
};

struct RunOptions {
  JobOptions job;
  std::filesystem::path devices;                ///< file of the devices to use; empty: a log
  std::filesystem::path record;                 ///< log to write of what is mapped; empty: none
  std::optional<SimulationOptions> simulation;  ///< what is behind the ports of `devices`
  std::uint32_t workers = 2;
  std::optional<std::uint32_t> wait_workers;  ///< before the first step; none: `workers`
  std::uint32_t domain = 0;
  std::string rate = "lossless";
  std::filesystem::path profiles_file;  ///< empty: built in
  bool explore = false;                 ///< the robot drives where it has not been, to the end
  std::optional<GoalOptions> goal;      ///< to drive to in job.map; none: a drive that maps
};

/// File name of the log, the devices or the simulated world.
std::string source_name(const RunOptions& options);

// What the base of a simulation is capable of.
inline constexpr std::uint32_t kSimulatedBaseBaud = 38'400;
inline constexpr double kSimulatedTurn_rad_s = 2.0;
inline constexpr double kSimulatedAcceleration = 1.5;  // m/s^2
/// Where the simulator of a run puts the port of "laser" or "base".
std::filesystem::path simulated_port(const RunOptions& options, const std::string& device);

class ServiceGroup {
 public:
  /// Starts all services in the given partition; their output goes to OUT/logs/<name>.log. Throws
  /// std::runtime_error when one cannot be started, with those before it ended.
  ServiceGroup(const RunOptions& options, const std::string& partition);

  struct Death {
    std::string name;
    std::string what;  ///< "localizer was killed by signal 9 (Killed); last line of its log: ..."
    bool is_worker = false;
    bool clean = false;  ///< with exit code 0
  };
  /// A service that has ended since the last call.
  std::optional<Death> next_death();

  /// To all of them, or to the one of that name.
  void send_signal(int signal_number, const std::string& name = {});
  /// Names of those that still run.
  [[nodiscard]] std::vector<std::string> running();

  /// Waits for all of them. Wall and CPU time of each, in the order of the stages of the work.
  std::vector<support::StageTime> wait();

 private:
  void start_source(const RunOptions& options, const std::vector<std::string>& common);
  void start_recorder(const RunOptions& options, const std::string& partition);
  void start(const std::string& name, const std::string& program,
             const std::vector<std::string>& arguments);

  std::filesystem::path programs_;
  std::filesystem::path logs_;
  std::vector<ChildProcess> children_;
  std::vector<bool> told_;  // that it has ended, by child
};

/// Asks all services to end and kills those that do not within some seconds, which `say` is told.
/// The loop goes on meanwhile: they say their final counts when they stop. `gateway_first`: while
/// scans may be on their way.
void stop(ServiceGroup& services, messaging::EventLoop& loop, bool gateway_first,
          const std::function<void(const std::string&)>& say);

}  // namespace topogeo::cli
