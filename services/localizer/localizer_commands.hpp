// What a command does to the session of the localizer.
#pragma once

#include <cstddef>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/session/slam_session.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::localizer {

struct CommandAnswer {
  bool accepted = false;
  std::string message;  ///< why not, or what will be done
};

/// The state of the localizer when a command is carried out.
struct CommandMoment {
  bool finished = false;           ///< the log has ended
  std::size_t stops_in_map = 0;    ///< of the map, or of the drive in a finished one
  geometry::Pose2 T_stop_robot{};  ///< the robot now, seen from its last stop; before the first: 0
};

/// Carries out a command between two steps. A pose that a command sets is that of now; the session
/// takes it over at the last stop: see stop_pose().
CommandAnswer carry_out(const service::LocalizationCommand& command, const CommandMoment& now,
                        localization::SlamSession& slam);

/// Where the last stop is by the pose of a command.
geometry::Pose2 stop_pose(const service::LocalizationCommand& command, const CommandMoment& now);

}  // namespace topogeo::localizer
