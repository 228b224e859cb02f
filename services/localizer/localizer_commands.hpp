// Effect of a command on the session of the localizer.
#pragma once

#include <cstddef>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/session/slam_session.hpp"

namespace topogeo::localizer {

struct CommandAnswer {
  bool accepted = false;
  std::string message;  ///< reason of the refusal, or the action taken
};

/// The state of the localizer when a command is carried out.
struct CommandMoment {
  bool finished = false;           ///< the log has ended
  std::size_t stops_in_map = 0;    ///< of the map; in a finished one, of the drive
  geometry::Pose2 T_stop_robot{};  ///< robot relative to its last stop; identity before one
};

/// Carries out a command between two steps. The pose in a command is the robot's current one; the
/// session applies it at the last stop: see stop_pose().
CommandAnswer carry_out(const service::LocalizationCommand& command, const CommandMoment& now,
                        localization::SlamSession& slam);

/// Pose of the last stop that follows from the robot pose in a command.
geometry::Pose2 stop_pose(const service::LocalizationCommand& command, const CommandMoment& now);

}  // namespace topogeo::localizer
