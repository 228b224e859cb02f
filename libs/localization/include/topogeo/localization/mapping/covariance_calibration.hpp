// How large the errors of matches are in truth, learned from matches that close a triangle.
//
// The covariance of a match has a floor and a margin for what the least squares of its points does
// not know. Much of that is the same for neighbouring stops (the thickness of a wall, the bias of a
// laser) and does not add up along a path: a prediction that added it up would be several times too
// wide after some metres. Three matches i-j, j-k, i-k show what does add up.
#pragma once

#include <Eigen/Core>

#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Of the relative pose of two stops however short the path: what an optimisation leaves of the
/// errors in a map, which are not independent from stop to stop.
Eigen::Matrix3d map_noise();

class CovarianceCalibration {
 public:
  /// A match as measured, with the covariance of match_covariance(), and the same way over a third
  /// stop.
  void add_triangle(const UncertainPose& direct, const UncertainPose& first,
                    const UncertainPose& second);

  /// The covariance of a match as the triangles so far have it.
  [[nodiscard]] Eigen::Matrix3d of_match(const Eigen::Matrix3d& covariance) const;

  /// Factor of the variances that a usual laser has; 1 before there is a triangle.
  [[nodiscard]] double factor() const;

 private:
  // A mean over all triangles, begun as if kUsual of them had been as usual.
  static constexpr double kUsual = 30.0;
  double sum_ = kUsual;
  double weight_ = kUsual;
};

}  // namespace topogeo::localization
