// topogeo base: operator commands to the base of a robot.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/service/base_confirmation.hpp"
#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/patience.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/program_connection.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

struct BaseRequest {
  DomainView view;
  std::string robot_id = "robot";
  double wait_s = 5.0;
  bool json = false;
  msg::BaseCommand command;
};

std::string_view name(msg::BaseState state) {
  switch (state) {
    case msg::kBaseReady:
      return "ready";
    case msg::kBaseMoving:
      return "moving";
    case msg::kBaseStarting:
      return "starting";
    case msg::kBaseEmergencyStop:
      return "emergency stop";
    case msg::kBaseHalted:
      return "halted";
    case msg::kBaseWatchdogExpired:
      return "watchdog expired";
    case msg::kBaseBumped:
      return "bumped";
    case msg::kBaseJoystick:
      return "joystick";
    case msg::kBaseMotorsOff:
      return "motors off";
    case msg::kBaseOffline:
      break;
  }
  return "offline";
}

void print_base(const msg::BaseStatus& status) {
  std::cout << status.robot_id().c_str() << ": " << name(status.state());
  if (status.reason().size() > 0) std::cout << ": " << status.reason().c_str();
  if (status.battery_v() > 0.0F) {
    std::cout << ", battery " << status.battery_v() << " V"
              << (status.battery_low() ? ", low" : "");
  }
  std::cout << (status.commands_taken() ? ", takes motion commands\n"
                                        : ", refuses motion commands\n");
}

void print_base_json(const msg::BaseStatus& status) {
  nlohmann::ordered_json json = {{"robot_id", status.robot_id().c_str()},
                                 {"state", name(status.state())},
                                 {"reason", status.reason().c_str()},
                                 {"commands_taken", status.commands_taken()},
                                 {"stands", status.stands()},
                                 {"battery_v", nullptr},
                                 {"battery_low", status.battery_low()},
                                 {"bumpers", status.bumpers()},
                                 {"stop_count", std::to_string(status.stop_count())}};
  if (status.battery_v() > 0.0F) json["battery_v"] = status.battery_v();
  std::cout << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
}

/// The next base status for which `wanted` holds; nothing when the patience ends first.
std::optional<msg::BaseStatus> next_status(
    messaging::Reader<msg::BaseStatus>& reader, const BaseRequest& request,
    support::Patience& patience, const std::function<bool(const msg::BaseStatus&)>& wanted) {
  std::optional<msg::BaseStatus> found;
  while (!found && !patience.is_over(support::monotonic_s())) {
    if (!reader.wait_for_data(milliseconds(50))) continue;
    reader.take([&](const msg::BaseStatus& status, const messaging::SampleInfo& info) {
      if (info.valid && status.robot_id() == request.robot_id.c_str() && wanted(status)) {
        found = status;
      }
    });
  }
  return found;
}

int show(const BaseRequest& request) {
  const messaging::Participant participant =
      join_for(request.view, "topogeo/base", request.robot_id);
  messaging::Reader<msg::BaseStatus> reader(participant);
  support::Patience patience(request.wait_s, support::monotonic_s());
  const auto status =
      next_status(reader, request, patience, [](const msg::BaseStatus&) { return true; });
  if (!status) throw std::runtime_error(nothing_alive(request.view, "base") + patience.reason());
  request.json ? print_base_json(*status) : print_base(*status);
  return service::kOk;
}

enum class Listener : std::uint8_t { kNone, kBase, kNavigator };

/// Waits for the base. A navigator hears halts and resets for a base that reports nothing, as one
/// of ROS. `request` gets the newest stop of the base, which a reset releases.
Listener find_listener(const messaging::Participant& participant,
                       messaging::Reader<msg::BaseStatus>& bases,
                       const messaging::Writer<msg::BaseCommand>& writer, BaseRequest& request,
                       support::Patience& patience) {
  constexpr double kBase_s = 2.0;  // a base that reports is found in that time
  messaging::Reader<msg::NavigatorStatus> navigators(participant);
  std::set<messaging::Handle> base_writers;
  std::set<messaging::Handle> navigator_writers;
  std::optional<double> navigator_since_s;
  const auto connected = [&](const messaging::Handle& program) {
    return writer.connected_with(program);
  };
  while (true) {
    bases.take([&](const msg::BaseStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.robot_id() != request.robot_id.c_str()) return;
      request.command.stop_count(status.stop_count());
      base_writers.insert(info.writer);
    });
    navigators.take([&](const msg::NavigatorStatus& status, const messaging::SampleInfo& info) {
      if (!info.valid || status.robot_id() != request.robot_id.c_str()) return;
      navigator_writers.insert(info.writer);
    });
    if (std::ranges::any_of(base_writers, connected)) return Listener::kBase;
    const double now_s = support::monotonic_s();
    const bool holds_itself =
        !base_writers.empty() || request.command.kind() == msg::kBaseSetLimits;
    if (!navigator_since_s && std::ranges::any_of(navigator_writers, connected)) {
      navigator_since_s = now_s;
    }
    if (!holds_itself && navigator_since_s && now_s - *navigator_since_s > kBase_s) {
      return Listener::kNavigator;
    }
    if (patience.is_over(now_s)) return Listener::kNone;
    static_cast<void>(bases.wait_for_data(milliseconds(20)));
  }
}

/// Sends a halt or a reset to the programs that command a base without a state of its own. Which
/// stop they keep is unknown, so a reset follows a halt that all of them take.
int send_to_navigator(messaging::Writer<msg::BaseCommand>& writer, BaseRequest& request) {
  support::Patience patience(request.wait_s, support::monotonic_s());
  const bool resets = request.command.kind() == msg::kBaseReset;
  request.command.stop_count(service::OperatorStop::new_number());
  request.command.kind(msg::kBaseHalt);
  send_with(writer, request.command, patience);
  if (resets) {
    request.command.kind(msg::kBaseReset);
    request.command.sequence_number(1);
    send_with(writer, request.command, patience);
  }
  std::cout << request.robot_id << ": no base reports its state; the navigator "
            << (resets ? "holds the robot no longer: it may move\n"
                       : "holds the robot until the reset\n");
  return service::kOk;
}

/// Sends the command and shows the base's state afterwards.
int send_base_command(BaseRequest request) {
  const messaging::Participant participant =
      join_for(request.view, "topogeo/base", request.robot_id);
  messaging::Reader<msg::BaseStatus> reader(participant);
  messaging::Writer<msg::BaseCommand> writer(participant);
  support::Patience connecting(request.wait_s, support::monotonic_s());
  const Listener listener = find_listener(participant, reader, writer, request, connecting);
  if (listener == Listener::kNone) {
    throw std::runtime_error(nothing_alive(request.view, "base") + connecting.reason());
  }
  messaging::set_header(request.command, request.robot_id, 0, 0);
  messaging::set_client_id(request.command, support::process_name());
  if (listener == Listener::kNavigator) return send_to_navigator(writer, request);
  if (request.command.kind() == msg::kBaseHalt) {
    request.command.stop_count(service::OperatorStop::new_number());
  }
  support::Patience patience(request.wait_s, support::monotonic_s());
  send_with(writer, request.command, patience);
  const msg::BaseCommandKind kind = request.command.kind();
  const auto status = next_status(reader, request, patience, [&](const msg::BaseStatus& now) {
    return service::confirms(now, kind) || service::refuses(now, request.command);
  });
  if (!status) {
    throw std::runtime_error(
        fmt::format("robot '{}' did not carry out the command within {:.0f} ms{}", request.robot_id,
                    1000.0 * request.wait_s, patience.reason()));
  }
  print_base(*status);
  if (service::confirms(*status, kind)) return service::kOk;
  throw std::runtime_error(fmt::format(
      "robot '{}' was stopped again meanwhile: repeat the reset to release it", request.robot_id));
}

void add_base_options(command_line::Command& app, BaseRequest& request) {
  add_robot_option(app, request.robot_id, "robot of the base");
  add_domain_options(app, request.view);
  app.add_option("--wait-seconds", request.wait_s, "how long to wait for the base")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

void add_limits(command_line::Command& group, const std::shared_ptr<BaseRequest>& request,
                int& exit_code) {
  command_line::Command* limits =
      group.add_subcommand("limits", "Set its largest speeds and accelerations");
  auto values = std::make_shared<std::array<double, 4>>();
  constexpr double kMost = 100.0;
  const command_line::Check range = command_line::range(1e-3, kMost);
  limits->add_option("linear", (*values)[0], "m/s")->required()->check(range);
  limits->add_option("angular", (*values)[1], "rad/s")->required()->check(range);
  limits->add_option("linear-acceleration", (*values)[2], "m/s^2")->required()->check(range);
  limits->add_option("angular-acceleration", (*values)[3], "rad/s^2")->required()->check(range);
  limits->footer("Values above those of the gateway's device file are reduced to them.");
  add_base_options(*limits, *request);
  limits->callback([request, values, &exit_code] {
    request->command.kind(msg::kBaseSetLimits);
    request->command.largest_linear_mps((*values)[0]);
    request->command.largest_angular_radps((*values)[1]);
    request->command.linear_acceleration_mps2((*values)[2]);
    request->command.angular_acceleration_radps2((*values)[3]);
    exit_code = send_base_command(*request);
  });
}

}  // namespace

void add_base_command(command_line::Command& app, int& exit_code) {
  command_line::Command* group =
      app.add_subcommand("base", "Show, halt or release the base of a robot");
  group->require_subcommand(1);
  auto request = std::make_shared<BaseRequest>();
  command_line::Command* status = group->add_subcommand("status", "Show its state");
  add_base_options(*status, *request);
  status->add_flag("--json", request->json, "for programs: fields as in idl/sensor.idl");
  status->callback([request, &exit_code] { exit_code = show(*request); });
  command_line::Command* halt =
      group->add_subcommand("halt", "Stop it; it refuses to move until reset");
  add_base_options(*halt, *request);
  halt->callback([request, &exit_code] {
    request->command.kind(msg::kBaseHalt);
    exit_code = send_base_command(*request);
  });
  command_line::Command* reset =
      group->add_subcommand("reset", "Let it move again after a halt or an emergency stop");
  add_base_options(*reset, *request);
  reset->callback([request, &exit_code] {
    request->command.kind(msg::kBaseReset);
    exit_code = send_base_command(*request);
  });
  add_limits(*group, request, exit_code);
}

}  // namespace topogeo::cli
