// Constant-velocity prediction of a laser that is carried about: a Kalman filter of its velocity,
// which goes on but may change within a second by as much as this laser usually moves. One model
// covers scans at 10 Hz, whose velocity is known, and scans seconds apart, which can be anywhere
// that a walking person or an indoor robot gets to.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

class MotionFilter {
 public:
  MotionFilter();

  /// The motion in the next `dt_s` > 0 seconds, in the frame of the last pose, in which `scans` >=
  /// 1 scans come. It covers a laser whose velocity is unknown, but not steps far beyond the usual
  /// ones: some robots write a scan each half metre, however long it takes.
  [[nodiscard]] UncertainPose predict(double dt_s, int scans = 1) const;

  /// The last velocity, m/s forward and left and rad/s, in the frame of the last pose.
  [[nodiscard]] const Eigen::Vector3d& velocity() const { return velocity_.mean; }

  /// The speed at which this laser usually moves, m/s.
  [[nodiscard]] double usual_speed() const;

  /// The motion in the last `dt_s` > 0 seconds as the scans measured it, without the prediction. A
  /// direction that the scans did not measure has a large variance.
  void update(double dt_s, const UncertainPose& measured);

 private:
  struct Velocity {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // m/s, m/s, rad/s in the frame of the robot
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  /// A mean square over the last steps.
  class MeanSquare {
   public:
    MeanSquare(double weighted, double weight) : weighted_(weighted), weight_(weight) {}
    void add(double squared);
    [[nodiscard]] double mean() const { return weighted_ / weight_; }

   private:
    double weighted_;
    double weight_;
  };
  [[nodiscard]] Velocity after(double dt_s) const;
  [[nodiscard]] Eigen::Matrix3d usual() const;  // covariance of a velocity that is not known

  MeanSquare speed2_;
  MeanSquare turn_rate2_;
  MeanSquare step2_m2_;
  MeanSquare turn2_rad2_;
  Velocity velocity_;
};

}  // namespace topogeo::localization
