// Pose of the robot between two stops.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// Current T_map_robot: the pose of the last stop, then the relative pose of the newest scan that
/// was matched with the scan of that stop, then the odometry since. Without such a scan (`tracked`
/// null, or not matched) only the odometry since the stop. `T_odom_stop`: the odometry at the stop.
UncertainPose live_pose(const UncertainPose& T_map_stop, const geometry::Pose2& T_odom_stop,
                        const topomap::TrackedScan* tracked, const geometry::Pose2& T_odom_robot,
                        const OdometryNoise& noise);

}  // namespace topogeo::localization
