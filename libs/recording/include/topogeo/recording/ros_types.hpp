// The messages of ROS that recordings hold and we write, by the names that they have in ROS.
#pragma once

#include "topogeo/ros2/types.h"

namespace topogeo::recording::ros {

using Time = builtin_interfaces::msg::dds_::Time_;
using Duration = builtin_interfaces::msg::dds_::Duration_;
using Header = std_msgs::msg::dds_::Header_;
using ColorRgba = std_msgs::msg::dds_::ColorRGBA_;
using Point = geometry_msgs::msg::dds_::Point_;
using Vector3 = geometry_msgs::msg::dds_::Vector3_;
using Quaternion = geometry_msgs::msg::dds_::Quaternion_;
using Pose = geometry_msgs::msg::dds_::Pose_;
using PoseWithCovariance = geometry_msgs::msg::dds_::PoseWithCovariance_;
using PoseWithCovarianceStamped = geometry_msgs::msg::dds_::PoseWithCovarianceStamped_;
using Transform = geometry_msgs::msg::dds_::Transform_;
using TransformStamped = geometry_msgs::msg::dds_::TransformStamped_;
using Twist = geometry_msgs::msg::dds_::Twist_;
using TwistWithCovariance = geometry_msgs::msg::dds_::TwistWithCovariance_;
using LaserScan = sensor_msgs::msg::dds_::LaserScan_;
using CompressedImage = sensor_msgs::msg::dds_::CompressedImage_;
using Odometry = nav_msgs::msg::dds_::Odometry_;
using MapMetaData = nav_msgs::msg::dds_::MapMetaData_;
using OccupancyGrid = nav_msgs::msg::dds_::OccupancyGrid_;
using TfMessage = tf2_msgs::msg::dds_::TFMessage_;
using UvCoordinate = visualization_msgs::msg::dds_::UVCoordinate_;
using MeshFile = visualization_msgs::msg::dds_::MeshFile_;
using Marker = visualization_msgs::msg::dds_::Marker_;
using MarkerArray = visualization_msgs::msg::dds_::MarkerArray_;

}  // namespace topogeo::recording::ros
