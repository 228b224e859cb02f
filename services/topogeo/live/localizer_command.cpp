// topogeo localizer: commands to a running localizer, and its answers.
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/session/slam_session.hpp"

#include "commands.hpp"
#include "common/domain_view.hpp"
#include "common/service_request.hpp"

namespace topogeo::cli {
namespace {

struct LocalizerRequest {
  DomainView view;
  std::string robot_id = "robot";
  std::string pose;
  std::string mode;
  double wait_s = 5.0;
};

/// Prints the reply. Throws std::runtime_error when there is no answer.
int send_localizer_command(const LocalizerRequest& request,
                           const service::LocalizationCommand& command) {
  const msg::LocalizationReply reply =
      ask<msg::LocalizationReply>({request.view, request.robot_id, request.wait_s},
                                  service::to_msg(command, request.robot_id, 0, 0));
  (reply.accepted() ? std::cout : std::cerr)
      << (reply.accepted() ? "accepted: " : "topogeo: refused: ") << reply.message().c_str()
      << '\n';
  return reply.accepted() ? service::kOk : service::kFailure;
}

void add_request_options(command_line::Command& app, LocalizerRequest& request) {
  add_robot_option(app, request.robot_id, "robot of the localizer");
  add_domain_options(app, request.view);
  app.add_option("--wait-seconds", request.wait_s, "how long to wait for the answer")
      ->check(command_line::range(0.1, kLongestWait_s))
      ->capture_default_str();
}

}  // namespace

void add_localizer_command(command_line::Command& app, int& exit_code) {
  command_line::Command* group = app.add_subcommand("localizer", "Command a running localizer");
  group->require_subcommand(1);
  auto request = std::make_shared<LocalizerRequest>();

  command_line::Command* set_pose = group->add_subcommand("set-pose", "Set the pose of the robot");
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
      group->add_subcommand("mode", "Extend the map, or localize in it without changes");
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
