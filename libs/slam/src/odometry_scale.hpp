// Scale error of odometry, learned while the robot drives: a wheel worn by half a millimetre, a
// carpet.
//
// Where scans measure the distance, odometry hardly counts. Along bare walls it is the only
// measurement of the distance, and a systematic error of two percent bends every corridor of the
// map.
#pragma once

#include <cstddef>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

/// A step with its position scaled.
geometry::Pose2 scaled(const geometry::Pose2& T_by_odometry, double factor);

class OdometryScale {
 public:
  /// One step by odometry, as recorded, and by an accepted match of the same two stops. It counts
  /// only where the match measures the distance: a step of 0.2 m or more, nearly straight, with a
  /// deviation of 0.04 m or less along it.
  void add(const geometry::Pose2& T_by_odometry, const UncertainPose& T_by_match);

  /// Distances of matches over those of odometry; 1 before the first match.
  [[nodiscard]] double factor() const { return matched_ / driven_; }

  /// After so many steps an older one counts a third: the floor changes, and tyres lose air.
  static constexpr std::size_t kMemory = 500;

 private:
  // Starts as if one metre were known to 1 %: forty steps, so that noise of a few bends no map.
  static constexpr double kPrior = 1.0 / (0.01 * 0.01);
  // Sums of distances in metres over variances. Squared distances would be too large, because they
  // include the noise of odometry.
  double matched_ = kPrior;
  double driven_ = kPrior;
};

}  // namespace topogeo::localization
