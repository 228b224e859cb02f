// topogeo demo: maps a synthetic floor with all services and prints the error of the result.
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/world/world.hpp"

#include "commands.hpp"
#include "run/demo_world.hpp"
#include "run/run_log.hpp"
#include "web/web_run.hpp"

namespace topogeo::cli {
namespace {

struct DemoOptions {
  RunOptions run;
  GoalOptions goal{};
  bool unknown_start = false;
  std::optional<std::filesystem::path> world;
  bool with_devices = false;
  SimulatorOptions simulation{};
};

world::World read_world(const std::optional<std::filesystem::path>& file) {
  try {
    return file ? world::load_world(*file) : world::parse_world(kDemoWorld, "built-in floor");
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

simulation::SimulatedLog simulate(const world::World& world) {
  try {
    return simulation::simulate_log(world, {});
  } catch (const std::exception& error) {  // a world that cannot be driven through
    throw service::BadInputError(world.name + ": " + error.what());
  }
}

void write(const simulation::SimulatedLog& log, const std::filesystem::path& log_file,
           const std::filesystem::path& truth_file) {
  scan::CarmenLogWriter writer(log_file);
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    writer.write(log.scans[i]);
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
  }
  writer.close();
  storage::write_trajectory_tum(truth_file, truth);
}

int show_demo(DemoOptions options) {
  static_cast<void>(check_inputs(options.run.job));
  const world::World world = read_world(options.world);
  support::check_writable_directory(options.run.job.out);
  const simulation::SimulatedLog log = simulate(world);
  options.run.job.log = options.run.job.out / "floor.clf.gz";
  options.run.job.reference = options.run.job.out / "truth.tum";
  write(log, options.run.job.log, *options.run.job.reference);
  std::cerr << "simulated a drive through '" << world.name << "': " << log.scans.size()
            << " scans in " << options.run.job.log.string() << ", the true poses in "
            << options.run.job.reference->string() << '\n';
  return run_log(options.run);
}

/// The map of a drive through the world, with its places, made in one process.
storage::MapDocument make_map(const DemoOptions& options, const pipeline::Config& config,
                              const world::World& world) {
  const simulation::SimulatedLog log = simulate(world);
  pipeline::MappingRun mapping(config, options.run.job.robot_id);
  for (const scan::Scan& scan : log.scans) mapping.add(scan);
  storage::MapDocument document = mapping.finish();
  const geometry::Pose2 T_map_world = geometry::inverse(log.T_world_robot.front());
  for (const world::NamedPlace& place : world.places) {
    document.drawing.places.push_back(
        planning::moved({place.name, place.position_m, place.station_heading_rad}, T_map_world));
  }
  return document;
}

/// The world's file; writes the built-in world unless another was given.
std::filesystem::path world_file(const DemoOptions& options) {
  if (options.world) return *options.world;
  std::filesystem::path file = options.run.job.out / "floor.world.yaml";
  support::write_file_atomically(file, kDemoWorld);
  return file;
}

/// Maps the floor by a drive; a simulated robot then starts in that map, whose file is among the
/// results.
void put_robot_on_mapped_floor(DemoOptions& options) {
  const Inputs inputs = check_inputs(options.run.job);
  const world::World world = read_world(options.world);
  support::check_writable_directory(options.run.job.out);
  std::cerr << "mapping '" << world.name << "' from a simulated drive\n";
  options.run.job.map = options.run.job.out / "floor.map.pb";
  storage::write_map_file(*options.run.job.map, make_map(options, inputs.config.config, world));
  options.simulation.world = world_file(options);
  options.run.simulation = options.simulation;
  if (!options.unknown_start) options.run.job.initial_pose = "0,0,0";
}

/// Sends a simulated robot to a place on the floor, in the map of an earlier drive.
int show_goto(DemoOptions options) {
  static_cast<void>(to_goal(options.goal));
  check_picture(options.goal.picture);
  put_robot_on_mapped_floor(options);
  options.run.goal = options.goal;
  std::cerr << "a simulated robot is sent to " << options.goal.target
            << "; this takes as long as the drive\n";
  return run_goto(options.run);
}

/// Shows a page for a simulated robot in the map of an earlier drive.
int show_web(DemoOptions options) {
  put_robot_on_mapped_floor(options);
  return run_web(options.run);
}

/// Maps the same floor through the serial lines of emulated devices, in real time.
int show_devices(DemoOptions options) {
  static_cast<void>(check_inputs(options.run.job));
  support::check_writable_directory(options.run.job.out);
  options.simulation.world = world_file(options);
  options.run.simulation = options.simulation;
  std::cerr << "a simulated robot drives through the floor; this takes as long as the drive\n";
  return run_devices(options.run);
}

}  // namespace

void add_demo_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("demo", "Map a synthetic floor and compare the result with the truth");
  auto options = std::make_shared<DemoOptions>();
  // Faster than a B21 usually drives, so that nobody has to wait for long.
  options->simulation.speed_m_per_s = 1.5;
  command->add_option("--out", options->run.job.out, "directory for the results")
      ->required()
      ->type_name("DIR");
  command
      ->add_option("--world", options->world, "another floor (YAML), instead of the built-in one")
      ->type_name("FILE");
  add_common_options(*command, options->run.job);
  add_run_options(*command, options->run);
  command_line::Option* sim = command->add_flag(
      "--sim", options->with_devices, "drive through it with emulated devices on serial ports");
  add_simulation_options(*command, options->simulation, sim);
  add_goal_run_options(*command, options->goal, options->unknown_start, nullptr);
  command->get_option("--goto")->excludes(sim);
  auto web = std::make_shared<WebOptions>();
  auto with_web = std::make_shared<bool>(false);
  command_line::Option* page = command->add_flag(
      "--web", *with_web, "open a page in the browser to send a simulated robot, until Ctrl-C");
  page->excludes(sim)->excludes(command->get_option("--goto"));
  add_web_options(*command, *web, page);
  command->callback([options, web, with_web, &exit_code] {
    if (*with_web) {
      check_web_options(*web);
      options->run.web = *web;
      exit_code = show_web(*options);
    } else if (!options->goal.target.empty()) {
      exit_code = show_goto(*options);
    } else {
      exit_code = options->with_devices ? show_devices(*options) : show_demo(*options);
    }
  });
}

}  // namespace topogeo::cli
