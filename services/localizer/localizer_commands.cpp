// The part of LocalizerService that carries out commands.
#include <exception>
#include <string>

#include "localizer_service.hpp"

namespace topogeo::localizer {

void LocalizerService::carry_out_commands() {
  commands_.carry_out(
      [this](const service::LocalizationCommand& command) {
        CommandDesk::Answer answer = carry_out(command);
        send_pose();
        return answer;
      },
      last_stop_.stamp_ns);
}

CommandDesk::Answer LocalizerService::carry_out(const service::LocalizationCommand& command) {
  const bool maps = localizer_.map_localizer() == nullptr;
  switch (command.kind) {
    case msg::kCommandSetPose:
      if (maps) return {false, "it makes a map, in which its pose is not to be chosen"};
      return set_pose(command);
    case msg::kCommandSearch:
      if (maps) return {false, "it makes a map: there is no finished one to search"};
      localizer_.map_localizer()->search();
      return {true, "searches the whole map from the next stop on"};
    case msg::kCommandSwitchToLocalization:
      if (!maps) return {false, "it localizes in a finished map already"};
      if (finished_) return {false, "the log has ended"};
      try {
        if (maps_.empty()) return {false, "there is no map yet"};
        localizer_.freeze(maps_);
      } catch (const std::exception& error) {
        return {false, error.what()};
      }
      return {true, "the map of " + std::to_string(maps_.size()) + " stops stays as it is"};
    case msg::kCommandSwitchToMapping:
      if (maps) return {false, "it makes a map already"};
      return {false, "a finished map is not continued"};
  }
  return {false, "unknown command"};
}

// The pose is that of now; the localizer wants that of the last stop.
CommandDesk::Answer LocalizerService::set_pose(const service::LocalizationCommand& command) {
  geometry::Pose2 T_map_stop = command.T_map_robot;
  if (last_map_) {
    const geometry::Pose2 T_stop_robot =
        geometry::between(last_map_->T_odom_robot, newest_.T_odom_robot);
    T_map_stop = command.T_map_robot * geometry::inverse(T_stop_robot);
  }
  localizer_.map_localizer()->set_pose(T_map_stop, command.covariance);
  if (last_map_) {
    last_stop_.T_map_robot = T_map_stop;
    last_stop_.covariance = command.covariance;
  }
  return {true, "goes on from there"};
}

}  // namespace topogeo::localizer
