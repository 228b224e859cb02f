// Short names for the ROS 2 messages that robots, viewers and recordings exchange with us.
#pragma once

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
using ColorRgba = std_msgs::msg::dds_::ColorRGBA_;
using CompressedImage = sensor_msgs::msg::dds_::CompressedImage_;
using DiagnosticArray = diagnostic_msgs::msg::dds_::DiagnosticArray_;
using DiagnosticStatus = diagnostic_msgs::msg::dds_::DiagnosticStatus_;
using Duration = builtin_interfaces::msg::dds_::Duration_;
using Header = std_msgs::msg::dds_::Header_;
using LaserScan = sensor_msgs::msg::dds_::LaserScan_;
using MapMetaData = nav_msgs::msg::dds_::MapMetaData_;
using Marker = visualization_msgs::msg::dds_::Marker_;
using MarkerArray = visualization_msgs::msg::dds_::MarkerArray_;
using MeshFile = visualization_msgs::msg::dds_::MeshFile_;
using OccupancyGrid = nav_msgs::msg::dds_::OccupancyGrid_;
using OccupancyGridUpdate = map_msgs::msg::dds_::OccupancyGridUpdate_;
using Odometry = nav_msgs::msg::dds_::Odometry_;
using Path = nav_msgs::msg::dds_::Path_;
using Point = geometry_msgs::msg::dds_::Point_;
using Pose = geometry_msgs::msg::dds_::Pose_;
using PoseStamped = geometry_msgs::msg::dds_::PoseStamped_;
using PoseWithCovariance = geometry_msgs::msg::dds_::PoseWithCovariance_;
using PoseWithCovarianceStamped = geometry_msgs::msg::dds_::PoseWithCovarianceStamped_;
using Quaternion = geometry_msgs::msg::dds_::Quaternion_;
using TFMessage = tf2_msgs::msg::dds_::TFMessage_;
using Time = builtin_interfaces::msg::dds_::Time_;
using Transform = geometry_msgs::msg::dds_::Transform_;
using TransformStamped = geometry_msgs::msg::dds_::TransformStamped_;
using Twist = geometry_msgs::msg::dds_::Twist_;
using TwistStamped = geometry_msgs::msg::dds_::TwistStamped_;
using TwistWithCovariance = geometry_msgs::msg::dds_::TwistWithCovariance_;
using UvCoordinate = visualization_msgs::msg::dds_::UVCoordinate_;
using Vector3 = geometry_msgs::msg::dds_::Vector3_;

}  // namespace topogeo::ros
