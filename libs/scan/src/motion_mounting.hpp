// Mounting of the laser from the motions of robot and laser between the lines of a log, for poses
// of two frames that drift against each other: T_robot * T_robot_laser = T_robot_laser * T_laser
// ("hand-eye calibration" in the plane).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

#include "carmen_line.hpp"

namespace topogeo::scan {

class MotionMounting {
 public:
  /// The poses of the next line, in the order of the log.
  void add(const LinePoses& poses);

  /// Straight motions show the heading, turns the position. Empty unless nine in ten motions fit
  /// within 5 cm, or if they do not show a laser that is 5 cm or more from the robot's point, or
  /// turned: poses that are apart for another reason show neither.
  [[nodiscard]] std::optional<geometry::Pose2> find() const;

 private:
  struct Motion {
    geometry::Pose2 robot;
    geometry::Pose2 laser;
  };

  [[nodiscard]] std::optional<double> heading_rad() const;

  std::optional<LinePoses> first_;  // of the motion that is not long enough yet
  std::vector<Motion> motions_;
};

}  // namespace topogeo::scan
