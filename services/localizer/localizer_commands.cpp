#include "localizer_commands.hpp"

#include <exception>

#include "topogeo/msg/trajectory.h"

namespace topogeo::localizer {

namespace {

CommandAnswer stop_mapping(const CommandMoment& now, localization::SlamSession& slam) {
  if (!slam.mapping()) return {false, "it already localizes in a finished map"};
  if (now.finished) return {false, "the log has ended"};
  if (now.stops_in_map == 0) return {false, "there is no map yet"};
  try {
    slam.mapping_session()->stop_mapping();
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
  return {true, "the map of " + std::to_string(now.stops_in_map) + " stops stays unchanged"};
}

CommandAnswer resume_mapping(const CommandMoment& now, localization::SlamSession& slam) {
  if (slam.mapping()) return {false, "it already extends a map"};
  if (slam.mapping_session() == nullptr) {
    return {false, "--map gives a read-only map; start with --continue to extend it"};
  }
  if (now.finished) return {false, "the log has ended"};
  try {
    slam.mapping_session()->resume_mapping();
  } catch (const std::exception& error) {
    return {false, error.what()};
  }
  return {true, "new stops extend the map of " + std::to_string(now.stops_in_map) + " stops"};
}

}  // namespace

CommandAnswer carry_out(const service::LocalizationCommand& command, const CommandMoment& now,
                        localization::SlamSession& slam) {
  const bool maps = slam.map_tracker() == nullptr;
  switch (command.kind) {
    case msg::kCommandSetPose:
      if (maps) return {false, "the pose cannot be set while a map is made"};
      slam.map_tracker()->set_pose(stop_pose(command, now), command.covariance);
      return {true, "localization continues from this pose"};
    case msg::kCommandSearch:
      if (maps) return {false, "a search needs a finished map; this one is being made"};
      slam.map_tracker()->search();
      return {true, "the whole map is searched from the next stop on"};
    case msg::kCommandSwitchToLocalization:
      return stop_mapping(now, slam);
    case msg::kCommandSwitchToMapping:
      return resume_mapping(now, slam);
  }
  return {false, "unknown command"};
}

geometry::Pose2 stop_pose(const service::LocalizationCommand& command, const CommandMoment& now) {
  return command.T_map_robot * geometry::inverse(now.T_stop_robot);
}

}  // namespace topogeo::localizer
