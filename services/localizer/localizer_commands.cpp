// The part of LocalizerService that carries out commands.
#include <exception>
#include <string>

#include "localizer_service.hpp"

namespace topogeo::localizer {

void LocalizerService::carry_out_commands() {
  commands_.carry_out(
      [this](const service::LocalizationCommand& command) {
        CommandChannel::Answer answer = carry_out(command);
        send_pose();
        return answer;
      },
      last_stop_.stamp_ns);
}

CommandChannel::Answer LocalizerService::carry_out(const service::LocalizationCommand& command) {
  const bool maps = slam_.follower() == nullptr;
  switch (command.kind) {
    case msg::kCommandSetPose:
      if (maps) return {false, "it makes a map, in which its pose is not to be chosen"};
      return set_pose(command);
    case msg::kCommandSearch:
      if (maps) return {false, "it makes a map: there is no finished one to search"};
      slam_.follower()->search();
      return {true, "searches the whole map from the next stop on"};
    case msg::kCommandSwitchToLocalization:
      return stop_mapping();
    case msg::kCommandSwitchToMapping:
      return resume_mapping();
  }
  return {false, "unknown command"};
}

CommandChannel::Answer LocalizerService::stop_mapping() {
  if (!slam_.mapping()) return {false, "it localizes in a finished map already"};
  if (finished_) return {false, "the log has ended"};
  if (stops_in_map() == 0) return {false, "there is no map yet"};
  try {
    slam_.mapping_session()->stop_mapping();
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
  return {true, "the map of " + std::to_string(stops_in_map()) + " stops stays as it is"};
}

CommandChannel::Answer LocalizerService::resume_mapping() {
  if (slam_.mapping()) return {false, "it makes a map already"};
  if (slam_.mapping_session() == nullptr) {
    return {false, "the map was given with --map to stay as it is; start with --continue"};
  }
  if (finished_) return {false, "the log has ended"};
  try {
    slam_.mapping_session()->resume_mapping();
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
  return {true, "new stops extend the map of " + std::to_string(stops_in_map()) + " stops"};
}

// The pose is that of now; the localizer wants that of the last stop.
CommandChannel::Answer LocalizerService::set_pose(const service::LocalizationCommand& command) {
  geometry::Pose2 T_map_stop = command.T_map_robot;
  if (last_map_) {
    const geometry::Pose2 T_stop_robot =
        geometry::between(last_map_->T_odom_robot, newest_.T_odom_robot);
    T_map_stop = command.T_map_robot * geometry::inverse(T_stop_robot);
  }
  slam_.follower()->set_pose(T_map_stop, command.covariance);
  if (last_map_) {
    last_stop_.T_map_robot = T_map_stop;
    last_stop_.covariance = command.covariance;
  }
  return {true, "goes on from there"};
}

}  // namespace topogeo::localizer
