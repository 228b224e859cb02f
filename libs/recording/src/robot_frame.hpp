// Finds the frame of the robot, whose motion odometry measures, in the transforms of a recording:
// drivers leave the child frame of odometry empty, or name a frame that the transforms do not have.
#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "topogeo/ros_conversions/frame_tree.hpp"

namespace topogeo::recording {

/// Frames that odometry states.
struct OdometryFrames {
  std::string odom;
  std::string child;
};

struct RobotFrame {
  std::string name;                                ///< the stated child frame if no other is found
  std::optional<Eigen::Isometry3d> T_robot_laser;  ///< empty if unknown or not constant
  bool laser_moves = false;                        ///< on the robot
  std::string note;  ///< for people: a choice other than the stated one, or what is missing
};

/// The stated child frame, if constant transforms connect it to the laser. Otherwise the frame that
/// moves under the odometry frame and carries the laser, or, without such transforms, the one with
/// a usual name (base_link, base_footprint, base), or the root above the laser. Names without an
/// equal among the transforms stand for the only one that differs by its prefix.
RobotFrame find_robot_frame(const ros::FrameTree& tree, const OdometryFrames& stated,
                            const std::string& laser);

/// "base_link" for "robot1/base_link".
std::string name_without_prefix(const std::string& frame);
/// "robot1" for "robot1/base_link"; empty without a prefix.
std::string prefix_of(const std::string& frame);

}  // namespace topogeo::recording
