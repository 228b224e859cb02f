// Conversion of ROS orders to ours.
#pragma once

#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/service/conversions.hpp"

#include "settings.hpp"

namespace topogeo::ros_bridge {

/// A goal at that pose, in frame map, odom or robot, as far as the transforms are given. The
/// heading is left out when the quaternion has no length. Throws std::invalid_argument naming the
/// frame, or for coordinates that are not finite or exceed ros::kFarthest_m.
service::Goal to_goal(const ros::PoseStamped& message, const Settings::Frames& frames,
                      const std::optional<geometry::Pose2>& T_map_odom,
                      const std::optional<geometry::Pose2>& T_map_robot);

/// The command that sets the pose. An invalid covariance, such as all zeros, becomes that of a
/// click on a map: half a metre, 15 degrees. Throws std::invalid_argument for a frame other than
/// the map's and for an invalid pose.
service::LocalizationCommand to_set_pose(const ros::PoseWithCovarianceStamped& message,
                                         const std::string& map_frame);

/// The gateway's limit: a velocity never holds for longer.
inline constexpr double kLongestVelocity_s = 0.5;

/// The command for that velocity, without a header, valid for the longest time. Throws
/// std::invalid_argument for speeds that are not finite and for motions other than along x and
/// about z.
msg::MotionCommand to_motion(const ros::Twist& twist);

}  // namespace topogeo::ros_bridge
