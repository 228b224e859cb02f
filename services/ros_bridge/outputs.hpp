// Conversion of our state to ROS messages.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/status.h"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "grid_mirror.hpp"

namespace topogeo::ros_bridge {

/// REP 105: T_map_odom, the localizer's correction to the odometry of the same moment.
geometry::Pose2 correction_of(const geometry::Pose2& T_map_robot,
                              const geometry::Pose2& T_odom_robot);

/// Height, roll and pitch are known to be about 0.
ros::PoseWithCovarianceStamped to_ros(const service::LivePose& pose, const std::string& frame);

/// Each pose points to the next one, the last as the goal demands. No poses when there is no route.
ros::Path to_path(const msg::Route& route, const std::string& frame);

ros::Twist to_ros(double linear_mps, double angular_radps);

/// A beam without an echo is infinite. `longest_m`: largest range of the laser.
ros::LaserScan to_ros(const msg::Scan& scan, const std::string& frame, float longest_m);
ros::Odometry to_ros(const msg::Odometry& odometry, const std::string& odom,
                     const std::string& robot);

/// Nodes as spheres of their clearance class and branches as lines, after an order to delete all
/// other markers.
ros::MarkerArray graph_markers(const topomap::GlobalMap& map, const std::string& frame,
                               std::int64_t stamp_ns);
/// Names of zones and places, at their positions.
ros::MarkerArray room_markers(const GridMirror& map, const std::string& frame,
                              std::int64_t stamp_ns);

/// Level OK for a working service, a warning for a waiting one, an error for a failed one.
ros::DiagnosticStatus to_ros(const msg::ServiceStatus& status);

}  // namespace topogeo::ros_bridge
