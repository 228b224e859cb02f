// topogeo run with devices in place of a log: real ones, or those of a simulated robot.
#include <algorithm>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/simulation/world.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "commands.hpp"
#include "run_log.hpp"

namespace topogeo::cli {
namespace {

using topomap::StampedPose;

/// The devices of a simulation, as a file for the gateway.
void write_devices(const RunOptions& options) {
  const SimulationOptions& simulation = *options.simulation;
  support::write_file_atomically(
      options.devices, fmt::format("laser: {{port: '{}', baud: {}, kind: pls}}\n"
                                   "base:\n"
                                   "  port: '{}'\n"
                                   "  baud: {}\n"
                                   "  dialect: binary\n"
                                   "  largest_linear_mps: {}\n"
                                   "  largest_angular_radps: {}\n"
                                   "  linear_acceleration_mps2: {}\n"
                                   "  angular_acceleration_radps2: {}\n",
                                   simulated_port(options, "laser").string(), simulation.laser_baud,
                                   simulated_port(options, "base").string(), kSimulatedBaseBaud,
                                   simulation.speed_m_per_s, kSimulatedTurn_rad_s,
                                   kSimulatedAcceleration, 2.0 * kSimulatedTurn_rad_s));
}

/// Finds out before anything starts whether the world can be driven through.
void check_world(const SimulationOptions& simulation) {
  try {
    const simulation::World world = simulation::load_world(simulation.world);
    static_cast<void>(simulation::TourFollower(world.tour_m, {}));
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

void compare_with_truth(const RunOptions& options, const RunResult& result) {
  const std::filesystem::path& out = options.job.out;
  const std::filesystem::path truth_file = out / "truth.tum";
  const auto trajectory = storage::read_trajectory_tum(out / "trajectory.tum");
  storage::write_trajectory_tum(truth_file, truth_at(trajectory, result.truth));
  if (result.collisions > 0) std::cout << "collisions: " << result.collisions << '\n';
  print_comparison(std::cout, compare(out, truth_file));
}

}  // namespace

std::vector<StampedPose> truth_at(std::span<const StampedPose> poses,
                                  std::span<const StampedPose> truth) {
  std::vector<StampedPose> found;
  for (const StampedPose& pose : poses) {
    const auto after = std::lower_bound(
        truth.begin(), truth.end(), pose.stamp_ns,
        [](const StampedPose& known, std::int64_t stamp_ns) { return known.stamp_ns < stamp_ns; });
    if (after == truth.begin() || after == truth.end()) continue;
    const StampedPose& before = *(after - 1);
    const double share = static_cast<double>(pose.stamp_ns - before.stamp_ns) /
                         static_cast<double>(after->stamp_ns - before.stamp_ns);
    const geometry::Pose2 step = geometry::between(before.pose, after->pose);
    found.push_back({pose.sequence, pose.stamp_ns,
                     before.pose * geometry::Pose2{share * step.x_m, share * step.y_m,
                                                   share * step.theta_rad}});
  }
  return found;
}

void prepare_simulation(RunOptions& options) {
  check_world(*options.simulation);
  support::check_writable_directory(options.job.out);
  options.devices = options.job.out / "devices.yaml";
  write_devices(options);
}

void add_simulation_options(CLI::App& app, SimulationOptions& options, CLI::Option* simulation) {
  const std::vector<CLI::Option*> added = {
      app.add_option("--seed", options.seed, "of a simulation: of noise, drift, doors and people"),
      app.add_option("--baud", options.laser_baud, "of a simulation: of the laser's line")
          ->check(CLI::IsMember({9600, 19200, 38400, 500000})),
      app.add_option("--odometry", options.odometry, "of a simulation: how the wheels err")
          ->check(CLI::IsMember({"mild", "b21", "none"})),
      app.add_option("--speed", options.speed_m_per_s, "of a simulation: of the drive, m/s")
          ->check(CLI::Range(0.05, 2.0)),
      app.add_option("--people", options.people, "of a simulation: who walk about")
          ->check(CLI::Range(0, 100))};
  for (CLI::Option* option : added) option->needs(simulation)->capture_default_str();
}

int run_devices(RunOptions options) {
  const double start_s = support::monotonic_s();
  pipeline::LoadedConfig config;
  try {
    config = pipeline::load_config(options.job.config);
  } catch (const std::exception& error) {
    throw service::UsageError(error.what());
  }
  if (options.simulation) prepare_simulation(options);
  support::check_writable_directory(options.job.out);
  const RunResult result = RunSupervisor(options, 0).run();
  if (result.signal_number != 0) {
    std::cerr << "topogeo: stopped, no map was written\n";
    return kSignalBase + result.signal_number;
  }
  if (!result.finished) throw std::runtime_error(result.failure);

  storage::Report report = make_report(options, config.effective, result);
  report.wall_s = support::monotonic_s() - start_s;
  storage::write_report(options.job.out / "report.json", report);
  print_pool(std::cout, result.services);
  print_summary(std::cout, report, options.job.out);
  if (options.simulation) compare_with_truth(options, result);
  if (options.job.reference) {
    print_comparison(std::cout, compare(options.job.out, *options.job.reference));
  }
  return service::kOk;
}

}  // namespace topogeo::cli
