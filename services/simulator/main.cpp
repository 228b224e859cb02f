// A simulated robot: laser and base on pseudo-terminals, in a simulated world.
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/process_priority.hpp"

#include "simulator_service.hpp"

namespace {

using namespace topogeo;  // NOLINT(google-build-using-namespace)

/// --drift none.
constexpr simulation::OdometryDrift kPerfect{.range_scale_error = 0.0,
                                             .range_sigma_m_per_sqrt_m = 0.0,
                                             .heading_drift_rad_per_m = 0.0,
                                             .heading_sigma_rad_per_sqrt_m = 0.0,
                                             .turn_sigma_rad_per_sqrt_rad = 0.0};

simulation::OdometryDrift drift(const std::string& name, std::uint64_t seed) {
  if (name == "none") return kPerfect;
  return name == "b21" ? simulation::b21_odometry(seed) : simulation::OdometryDrift{};
}

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const devices::LaserModel& model : devices::laser_models()) names.emplace_back(model.name);
  return names;
}

std::vector<std::string> base_names() {
  std::vector<std::string> names;
  for (const devices::BaseModel& model : devices::base_models()) names.emplace_back(model.name);
  return names;
}

struct Arguments {
  std::filesystem::path world;
  int sonars = 24;
  std::string sonar_noise = "mild";
  std::string odometry = "mild";
  simulator::SimulatorOptions options;
};

void add_options(command_line::Command& app, Arguments& arguments) {
  simulation::RobotOptions& robot = arguments.options.devices.robot;
  app.add_option("--world", arguments.world, "world file")->required()->type_name("FILE");
  app.add_option(
         "--laser-port", arguments.options.devices.laser_port,
         "path of the link to the laser's port, or tcp://ADDRESS:PORT, or udp://ADDRESS:PORT for a "
         "laser that sends datagrams")
      ->required();
  app.add_option("--base-port", arguments.options.devices.base_port,
                 "path of the link to the base's port")
      ->required();
  app.add_option_function(
         "--laser-model",
         [&model = arguments.options.devices.laser.model](const std::string& name) {
           model = &devices::laser_model(name);
         },
         "model of the laser, as laser.model of the devices file")
      ->check(command_line::one_of(model_names()))
      ->default_str(model_names().front());
  app.add_option_function(
         "--base-model",
         [&model = arguments.options.devices.base.model](const std::string& name) {
           model = &devices::base_model(name);
         },
         "model of the base, as base.model of the devices file")
      ->check(command_line::one_of(base_names()))
      ->default_str(base_names().front());
  app.add_option("--base-baud", arguments.options.devices.base.baud, "baud rate of the base's line")
      ->check(command_line::one_of({1200, 2400, 4800, 9600, 19200, 38400, 57600, 115200}))
      ->capture_default_str();
  // A person sets this with the manufacturer's program on a real laser.
  app.add_option("--protective-field", arguments.options.devices.laser.protective_field_m,
                 "radius of the laser's protective field, which stops the robot, metres; 0: none")
      ->check(command_line::range(0.0, 4.0))
      ->capture_default_str();
  app.add_option("--warning-field", arguments.options.devices.laser.warning_field_m,
                 "radius of the laser's warning field, which slows the robot down, metres; 0: none")
      ->check(command_line::range(0.0, 15.0))
      ->capture_default_str();
  app.add_option("--seed", robot.seed, "seed of noise, drift, slip, doors and people")
      ->capture_default_str();
  app.add_option("--odometry", arguments.odometry,
                 "errors of the odometry: mild, b21 (as in a recorded log) or none")
      ->check(command_line::one_of({"mild", "b21", "none"}))
      ->capture_default_str();
  app.add_option("--sonars", arguments.sonars,
                 "number of sonars: 24 as on a B21, or 6 as on MACONDO")
      ->check(command_line::one_of({6, 24}))
      ->capture_default_str();
  app.add_option("--sonar-noise", arguments.sonar_noise,
                 "errors of the sonars: mild, or macondo (0.3 m and missing echoes beyond 2.5 m)")
      ->check(command_line::one_of({"mild", "macondo"}))
      ->capture_default_str();
  app.add_option("--slip", robot.slip.per_m, "slippery places per metre")
      ->check(command_line::range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--people", robot.wanderers,
                 "number of people who walk about, besides those of the world file")
      ->check(command_line::range(0, 1000))
      ->capture_default_str();
  app.add_option("--time-factor", arguments.options.time_factor,
                 "world time over real time; devices and their lines speed up with it, so values "
                 "other than 1 need programs whose clocks do, too")
      ->check(command_line::range(0.01, 100.0))
      ->capture_default_str();
}

world::World load(const std::filesystem::path& path) {
  try {
    return world::load_world(path);
  } catch (const std::runtime_error& error) {
    throw service::BadInputError(error.what());
  }
}

/// False when the process stood still and its peers may have forgotten it.
bool run(const service::Setup& setup, simulator::SimulatedWorld& world) {
  service::Service service(setup);
  const simulator::SimulatorService simulator(service, world);
  try {
    service.run();
  } catch (const service::StoodStill& error) {
    spdlog::warn("{}; connecting to the peers again", error.what());
    return service::Service::stopping();
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  return service::run_service(
      argc, argv, "simulator", "Emulates a laser and a base on serial ports in a simulated world.",
      [&](command_line::Command& app) { add_options(app, arguments); },
      [&](const service::Setup& setup) {
        simulation::RobotOptions& robot = arguments.options.devices.robot;
        robot.T_robot_laser = setup.config.config.local_mapper.T_robot_laser;
        robot.minimum_turning_radius_m =
            setup.config.config.navigator.guard.minimum_turning_radius_m;
        robot.odometry = drift(arguments.odometry, robot.seed);
        if (arguments.sonars == 6) robot.sonars = devices::macondo_sonars();
        if (arguments.sonar_noise == "macondo") robot.sonar = simulation::macondo_sonar_noise();
        simulator::SimulatedWorld world(load(arguments.world), arguments.options);
        // Real devices do not wait for other programs on the machine.
        static_cast<void>(support::go_first());
        // Only this process knows where the robot is, so the process continues.
        while (!run(setup, world)) {
        }
      });
}
