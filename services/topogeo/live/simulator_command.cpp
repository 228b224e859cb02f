// topogeo simulator: injects a fault into a running simulator.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/simulation.h"
#include "topogeo/msg/status.h"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/host.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/program_connection.hpp"

namespace topogeo::cli {
namespace {

const std::vector<std::pair<std::string, std::uint32_t>> kFaults = {
    {"bad-crc", msg::kSimulatedBadCrc},
    {"truncated", msg::kSimulatedTruncated},
    {"silence", msg::kSimulatedSilence},
    {"garbage", msg::kSimulatedGarbage},
    {"unplug", msg::kSimulatedUnplug},
    {"restart", msg::kSimulatedRestart},
    {"stuck-scan", msg::kSimulatedStuckScan},
    {"contaminated", msg::kSimulatedContaminated},
    {"echo", msg::kSimulatedEcho},
    {"joystick", msg::kSimulatedJoystick},
    {"emergency-stop", msg::kSimulatedEmergencyStop}};

struct SimulatorRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::uint32_t fault = msg::kSimulatedSilence;  ///< msg::SimulatedFault
  bool base = false;
  double duration_s = 1.0;
  double linear_mps = 0.3;
  double angular_radps = 0.0;
};

int send_simulator_command(const SimulatorRequest& request) {
  constexpr double kSimulatorPatience_s = 5.0;
  const messaging::Participant participant =
      join_for(request.view, "topogeo/simulator", request.robot_id);
  messaging::Writer<msg::SimulatorCommand> commands(participant);
  messaging::Reader<msg::ServiceStatus> statuses(participant);
  const auto of_robot = [&](const msg::ServiceStatus& status) {
    return status.service() == "simulator" && status.robot_id() == request.robot_id.c_str();
  };
  support::Patience patience(kSimulatorPatience_s, support::monotonic_s());
  if (!connect_with_program(statuses, commands, patience, of_robot)) {
    throw std::runtime_error(nothing_alive(request.view, "simulator") + patience.reason());
  }
  msg::SimulatorCommand command;
  messaging::set_header(command, request.robot_id, 0, 0);
  messaging::set_client_id(command, support::process_name());
  command.fault(static_cast<msg::SimulatedFault>(request.fault));
  command.device(request.base ? msg::kSimulatedBase : msg::kSimulatedLaser);
  command.duration_s(request.duration_s);
  command.linear_mps(request.linear_mps);
  command.angular_radps(request.angular_radps);
  patience.begin_again(support::monotonic_s());
  send_with(commands, command, patience);
  return service::kOk;
}

void add_simulator_options(command_line::Command& app, SimulatorRequest& request) {
  app.add_option("fault", request.fault,
                 "bad-crc, truncated, silence, garbage, unplug or restart (off and on again) of "
                 "the laser or, with --base, of the base; stuck-scan or contaminated of the laser; "
                 "echo, joystick or emergency-stop of the base")
      ->required()
      ->type_name("FAULT")
      ->named_values(kFaults);
  app.add_flag("--base", request.base, "inject the fault into the base, not the laser");
  app.add_option("--seconds", request.duration_s, "how long, in the simulated world")
      ->check(command_line::range(0.01, 3600.0))
      ->capture_default_str();
  app.add_option("--linear", request.linear_mps, "m/s by joystick")
      ->check(command_line::range(-3.0, 3.0))
      ->capture_default_str();
  app.add_option("--angular", request.angular_radps, "rad/s by joystick")
      ->check(command_line::range(-3.0, 3.0))
      ->capture_default_str();
  add_robot_option(app, request.robot_id, "robot of the simulator");
  add_domain_options(app, request.view);
}

}  // namespace

void add_simulator_command(command_line::Command& app, int& exit_code) {
  command_line::Command* command =
      app.add_subcommand("simulator", "Inject a fault into a running simulator");
  auto request = std::make_shared<SimulatorRequest>();
  add_simulator_options(*command, *request);
  command->callback([request, &exit_code] { exit_code = send_simulator_command(*request); });
}

}  // namespace topogeo::cli
