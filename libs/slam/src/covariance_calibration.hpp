// Actual size of match errors, learned from matches that close a triangle.
//
// The covariance of a match has a floor and a margin for errors that the least squares of its
// points cannot see. Many of these errors are the same for neighbouring stops (the thickness of a
// wall, the bias of a laser) and do not add up along a path: a prediction that added them up would
// be several times too wide after some metres. Three matches i-j, j-k, i-k show the part that does
// add up.
#pragma once

#include <Eigen/Core>

#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Covariance of the relative pose of two stops after an optimisation, whatever the path between
/// them: errors of a map are correlated from stop to stop, so they do not vanish on a short path.
Eigen::Matrix3d map_noise();

class CovarianceCalibration {
 public:
  /// Adds a measured match and the path over a third stop, all with the covariance of
  /// match_covariance().
  void add_triangle(const UncertainPose& direct, const UncertainPose& first,
                    const UncertainPose& second);

  /// The covariance of a match after calibration by the triangles so far.
  [[nodiscard]] Eigen::Matrix3d of_match(const Eigen::Matrix3d& covariance) const;

  /// Factor on the variances of a typical laser; 1 without triangles.
  [[nodiscard]] double factor() const;

 private:
  // A mean over all triangles that starts as if kUsual of them had been typical.
  static constexpr double kUsual = 30.0;
  double sum_ = kUsual;
  double weight_ = kUsual;
};

}  // namespace topogeo::localization
