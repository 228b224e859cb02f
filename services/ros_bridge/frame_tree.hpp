// The frames of a robot as /tf and /tf_static tell them: each has one parent (REP 105).
#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::ros_bridge {

class FrameTree {
 public:
  /// The newest transform of the frame `child` counts. False, and nothing taken, where the frame
  /// has another parent already.
  bool put(const std::string& parent, const std::string& child,
           const Eigen::Isometry3d& T_parent_child);

  /// Coordinates of `source` into those of `target`; empty where no chain of frames joins them.
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& target,
                                                      const std::string& source) const;

 private:
  struct Link {
    std::string parent;
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
  };
  /// The topmost frame above `frame`, and T_top_frame.
  [[nodiscard]] std::pair<std::string, Eigen::Isometry3d> to_top(const std::string& frame) const;

  std::map<std::string, Link> links_;  // by child
};

/// How a laser is fixed to the robot.
struct Mounting {
  geometry::Pose2 T_robot_laser;
  bool upside_down = false;  ///< it turns clockwise seen from above
};

/// The mounting seen from above; empty for a laser that is tilted by more than 8 degrees, whose
/// scans are not of a horizontal plane.
std::optional<Mounting> mounting_of(const Eigen::Isometry3d& T_robot_laser);

}  // namespace topogeo::ros_bridge
