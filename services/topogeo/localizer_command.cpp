// topogeo localizer: commands to a running localizer, and its answers.
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/localization/session/slam_session.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/host.hpp"

#include "commands.hpp"
#include "domain_view.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;

struct LocalizerRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::string pose;
  std::string mode;
  double wait_s = 5.0;
};

/// Sends the command and waits for its answer, which is printed. Throws std::runtime_error when
/// nobody answers.
int send_localizer_command(const LocalizerRequest& request, service::LocalizationCommand command) {
  command.client_id = support::process_name();
  command.request_id = std::random_device{}();
  const messaging::Participant participant = join(request.view, "topogeo/localizer");
  messaging::Writer<msg::LocalizationCommand> commands(participant);
  messaging::Reader<msg::LocalizationReply> replies(participant);
  const milliseconds patience(static_cast<std::int64_t>(1000.0 * request.wait_s));
  if (!commands.wait_for_matched(1, patience) || !replies.wait_for_matched(1, patience)) {
    throw std::runtime_error(nothing_alive(request.view, "localizer"));
  }
  if (!commands.write(service::to_msg(command, request.robot_id, 0, 0))) {
    throw std::runtime_error("the command could not be sent");
  }
  std::optional<msg::LocalizationReply> reply;
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!reply && std::chrono::steady_clock::now() < end) {
    if (!replies.wait_for_data(milliseconds(100))) continue;
    replies.take([&](const msg::LocalizationReply& message, const messaging::SampleInfo& info) {
      if (info.valid && message.request_id() == command.request_id &&
          message.client_id() == command.client_id.c_str()) {
        reply = message;
      }
    });
  }
  if (!reply) {
    throw std::runtime_error("no localizer of robot '" + request.robot_id + "' answered within " +
                             std::to_string(patience.count()) + " ms");
  }
  (reply->accepted() ? std::cout : std::cerr)
      << (reply->accepted() ? "accepted: " : "topogeo: refused: ") << reply->message().c_str()
      << '\n';
  return reply->accepted() ? service::kOk : service::kFailure;
}

void add_request_options(command_line::Command& app, LocalizerRequest& request) {
  app.add_option("--robot,--robot-id", request.robot_id, "whose localizer")->capture_default_str();
  add_domain_options(app, request.view);
  constexpr double kLongestWait_s = 3600.0;
  app.add_option("--wait-seconds", request.wait_s, "how long to wait for the answer")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

}  // namespace

void add_localizer_command(command_line::Command& app, int& exit_code) {
  command_line::Command* group = app.add_subcommand("localizer", "Command a running localizer");
  group->require_subcommand(1);
  auto request = std::make_shared<LocalizerRequest>();

  command_line::Command* set_pose = group->add_subcommand("set-pose", "The robot is there");
  set_pose->add_option("pose", request->pose, "x,y,degrees in the map")->required();
  add_request_options(*set_pose, *request);
  set_pose->callback([request, &exit_code] {
    service::LocalizationCommand command;
    command.kind = msg::kCommandSetPose;
    try {
      command.T_map_robot = pipeline::parse_pose(request->pose);
    } catch (const std::invalid_argument& error) {
      throw service::UsageError(error.what());
    }
    command.covariance = localization::given_pose_covariance();
    exit_code = send_localizer_command(*request, command);
  });

  command_line::Command* search =
      group->add_subcommand("search", "Forget the pose, search the whole map");
  add_request_options(*search, *request);
  search->callback([request, &exit_code] {
    service::LocalizationCommand command;
    command.kind = msg::kCommandSearch;
    exit_code = send_localizer_command(*request, command);
  });

  command_line::Command* mode =
      group->add_subcommand("mode", "Map, or localize in the map as it is");
  mode->add_option("mode", request->mode, "mapping or localization")
      ->required()
      ->check(command_line::one_of({"mapping", "localization"}));
  add_request_options(*mode, *request);
  mode->callback([request, &exit_code] {
    service::LocalizationCommand command;
    command.kind = request->mode == "mapping" ? msg::kCommandSwitchToMapping
                                              : msg::kCommandSwitchToLocalization;
    exit_code = send_localizer_command(*request, command);
  });
}

}  // namespace topogeo::cli
