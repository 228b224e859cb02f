// Orders of people on ROS as ours.
#pragma once

#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/service/conversions.hpp"

#include "settings.hpp"

namespace topogeo::ros_bridge {

/// A goal at that pose. Frames map, odom and that of the robot are known as far as poses are given.
/// Without a heading where the quaternion has no length. Throws std::invalid_argument naming the
/// frame, or coordinates that are no numbers up to ros::kFarthest_m.
service::Goal to_goal(const ros::PoseStamped& message, const Settings::Frames& frames,
                      const std::optional<geometry::Pose2>& T_map_odom,
                      const std::optional<geometry::Pose2>& T_map_robot);

/// The order that sets the pose. A covariance that is none, as all zeros, becomes that of a click
/// on a map: half a metre, 15 degrees. Throws std::invalid_argument for another frame than the
/// map's and for what is no pose.
service::LocalizationCommand to_set_pose(const ros::PoseWithCovarianceStamped& message,
                                         const std::string& map_frame);

/// As the gateway: a velocity never holds for longer.
inline constexpr double kLongestVelocity_s = 0.5;

/// The command of that velocity, without a header, for as long as one holds. Throws
/// std::invalid_argument for speeds that are no numbers and for other motions than along x and
/// about z.
msg::MotionCommand to_motion(const ros::Twist& twist);

}  // namespace topogeo::ros_bridge
