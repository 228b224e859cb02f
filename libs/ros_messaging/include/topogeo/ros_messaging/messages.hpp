// The messages of ROS 2 that we read and write, under short names.
#pragma once

#include <concepts>

#include "topogeo/ros2/diagnostic_msgs.h"
#include "topogeo/ros2/geometry_msgs.h"
#include "topogeo/ros2/map_msgs.h"
#include "topogeo/ros2/nav_msgs.h"
#include "topogeo/ros2/rosgraph_msgs.h"
#include "topogeo/ros2/sensor_msgs.h"
#include "topogeo/ros2/tf2_msgs.h"
#include "topogeo/ros2/visualization_msgs.h"

namespace topogeo::ros {

using Clock = rosgraph_msgs::msg::dds_::Clock_;
using DiagnosticArray = diagnostic_msgs::msg::dds_::DiagnosticArray_;
using DiagnosticStatus = diagnostic_msgs::msg::dds_::DiagnosticStatus_;
using Header = std_msgs::msg::dds_::Header_;
using LaserScan = sensor_msgs::msg::dds_::LaserScan_;
using Marker = visualization_msgs::msg::dds_::Marker_;
using MarkerArray = visualization_msgs::msg::dds_::MarkerArray_;
using OccupancyGrid = nav_msgs::msg::dds_::OccupancyGrid_;
using OccupancyGridUpdate = map_msgs::msg::dds_::OccupancyGridUpdate_;
using Odometry = nav_msgs::msg::dds_::Odometry_;
using Path = nav_msgs::msg::dds_::Path_;
using Point = geometry_msgs::msg::dds_::Point_;
using Pose = geometry_msgs::msg::dds_::Pose_;
using PoseStamped = geometry_msgs::msg::dds_::PoseStamped_;
using PoseWithCovarianceStamped = geometry_msgs::msg::dds_::PoseWithCovarianceStamped_;
using Quaternion = geometry_msgs::msg::dds_::Quaternion_;
using TFMessage = tf2_msgs::msg::dds_::TFMessage_;
using Time = builtin_interfaces::msg::dds_::Time_;
using TransformStamped = geometry_msgs::msg::dds_::TransformStamped_;
using Twist = geometry_msgs::msg::dds_::Twist_;
using TwistStamped = geometry_msgs::msg::dds_::TwistStamped_;

template <class T, class... Types>
concept OneOf = (std::same_as<T, Types> || ...);

/// The messages that have topics of their own.
template <class T>
concept Message =
    OneOf<T, Clock, DiagnosticArray, LaserScan, MarkerArray, OccupancyGrid, OccupancyGridUpdate,
          Odometry, Path, PoseStamped, PoseWithCovarianceStamped, TFMessage, Twist, TwistStamped>;

}  // namespace topogeo::ros
