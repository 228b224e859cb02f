// topogeo run with devices instead of a log: real ones, or those of a simulated robot.
#include <iostream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/simulation/simulated_robot.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/topomap/pose_at.hpp"
#include "topogeo/world/world.hpp"

#include "commands.hpp"
#include "device_config.hpp"
#include "run/run_log.hpp"

namespace topogeo::cli {
namespace {

using topomap::StampedPose;

/// The devices of a simulation, as a file for the gateway.
void write_devices(const RunOptions& options) {
  const SimulatorOptions& simulation = *options.simulation;
  sensor_gateway::DeviceFile file;
  const support::ConfigSchema schema = describe(file);  // with the default values
  if (!simulation.no_laser) file.laser.port = simulated_port(options, "laser").string();
  file.laser.model = &devices::laser_model(simulation.laser_model);
  file.laser.settings.baud = simulation.laser_baud;
  file.laser.kind = sensor_gateway::DeviceFile::Laser::Kind::kPls;
  file.base.port = simulated_port(options, "base").string();
  devices::BaseSettings& base = file.base.settings;
  base.model = &devices::base_model(simulation.base_model);
  file.base.baud = kSimulatedBaseBaud;
  base.dialect = devices::BaseDialect::kBinary;
  base.limits.linear_mps = simulation.speed_m_per_s;
  base.limits.angular_radps = kSimulatedTurn_rad_s;
  base.limits.linear_mps2 = kSimulatedAcceleration;
  base.limits.angular_radps2 = 2.0 * kSimulatedTurn_rad_s;
  std::ostringstream text;
  support::write_yaml(schema, text);
  support::write_file_atomically(options.devices, text.str());
}

std::vector<std::string> laser_names() {
  std::vector<std::string> names;
  for (const devices::LaserModel& model : devices::laser_models()) names.emplace_back(model.name);
  return names;
}

std::vector<std::string> base_names() {
  std::vector<std::string> names;
  for (const devices::BaseModel& model : devices::base_models()) names.emplace_back(model.name);
  return names;
}

/// Checks before the start that the devices are those that a run needs.
void check_devices(const RunOptions& options) {
  const auto check = [&options](const std::string& port, const char* key, const char* why) {
    if (port.empty()) {
      throw std::runtime_error(
          fmt::format("{}: key '{}': expected a port, {}", options.devices.string(), key, why));
    }
  };
  try {
    const sensor_gateway::DeviceConfig devices = sensor_gateway::load_devices(options.devices);
    check(devices.laser_port, "laser.port", "as maps are made of a laser's scans");
    if (options.explore) check(devices.base_port, "base.port", "as the robot is to drive");
  } catch (const std::runtime_error& error) {
    throw service::UsageError(error.what());
  }
}

/// Makes all services use the laser mounting that the ROS robot states.
void ask_for_mounting(RunOptions& options) {
  std::cerr << "topogeo: waiting for a scan of ROS and its transforms\n";
  options.laser.reset();
  options.laser = mounting_of_ros(*options.ros, common_arguments(options, "ros-mounting"),
                                  options.job.out / "logs" / "ros_mounting.log");
  std::cerr << "topogeo: laser at " << pipeline::mounting_argument(*options.laser)
            << ": from the transforms\n";
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
    if (const auto at = topomap::pose_at(truth, pose.stamp_ns)) {
      found.push_back({pose.sequence, pose.stamp_ns, *at});
    }
  }
  return found;
}

void check_world(const SimulatorOptions& simulation) {
  const world::World world = [&] {
    try {
      return world::load_world(simulation.world);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  simulation::RobotOptions robot;
  robot.seed = simulation.seed;
  robot.wanderers = simulation.people;
  try {
    const simulation::SimulatedRobot at_start(world, robot);
  } catch (const std::exception& error) {
    throw service::BadInputError(simulation.world.string() + ": " + error.what());
  }
}

/// The tour of a world has turns on the spot.
void refuse_tour_with_arcs(const RunOptions& options, const navigation::GuardConfig& guard) {
  if (options.explore || guard.minimum_turning_radius_m == 0.0) return;
  throw service::UsageError(
      "run: the tour of --sim turns on the spot, which base.minimum_turning_radius_m excludes: "
      "expected --explore or --goto");
}

void prepare_simulation(RunOptions& options) {
  check_world(*options.simulation);
  support::check_writable_directory(options.job.out);
  options.devices = options.job.out / "devices.yaml";
  write_devices(options);
}

void add_simulation_options(command_line::Command& app, SimulatorOptions& options,
                            command_line::Option* simulation) {
  const std::vector<command_line::Option*> added = {
      app.add_option("--seed", options.seed, "simulation: seed of noise, drift, doors and people"),
      app.add_option("--laser-model", options.laser_model,
                     "simulation: model of the laser, as laser.model of the devices file")
          ->check(command_line::one_of(laser_names())),
      app.add_option("--base-model", options.base_model,
                     "simulation: model of the base, as base.model of the devices file")
          ->check(command_line::one_of(base_names())),
      app.add_option("--baud", options.laser_baud,
                     "simulation: baud rate of the line of a sick_pls")
          ->check(command_line::one_of({9600, 19200, 38400, 500000})),
      app.add_option("--odometry", options.odometry, "simulation: errors of the odometry")
          ->check(command_line::one_of({"mild", "b21", "none"})),
      app.add_option("--speed", options.speed_m_per_s, "simulation: speed of the drive, m/s")
          ->check(command_line::range(0.05, 2.0)),
      app.add_option("--people", options.people, "simulation: number of people who walk about")
          ->check(command_line::range(0, 100))};
  app.add_flag("--no-laser", options.no_laser,
               "simulation with --goto: the robot has only sonars, starts at the base station of "
               "the map and is tracked by Markov localization")
      ->needs(simulation);
  for (command_line::Option* option : added) option->needs(simulation)->capture_default_str();
}

int run_devices(RunOptions options) {
  const double start_s = support::monotonic_s();
  const Inputs inputs = check_inputs(options.job);
  options.laser = inputs.config.config.local_mapper.T_robot_laser;  // for a recording
  if (options.simulation) {
    refuse_tour_with_arcs(options, inputs.config.config.navigator.guard);
    prepare_simulation(options);
  } else if (!from_ros(options)) {
    check_devices(options);
  }
  support::check_writable_directory(options.job.out);
  if (from_ros(options) && !inputs.config.laser_set) ask_for_mounting(options);
  const RunResult result = RunSupervisor(options, 0).run();
  if (result.signal_number != 0) {
    std::cerr << "topogeo: stopped, what was mapped is in " << options.job.out.string() << "\n";
    return kSignalBase + result.signal_number;
  }
  if (!result.finished) throw std::runtime_error(result.failure);

  storage::Report report = make_report(options, inputs.config.effective, result);
  add_overlaps(report, options.job, inputs.config.config);
  report.wall_s = support::monotonic_s() - start_s - result.stayed_s;
  storage::write_report(options.job.out / "report.json", report);
  print_pool(std::cout, result);
  print_summary(std::cout, report, options.job.out);
  if (options.simulation) compare_with_truth(options, result);
  if (options.job.reference) {
    print_comparison(std::cout, compare(options.job.out, *options.job.reference));
  }
  return service::kOk;
}

}  // namespace topogeo::cli
