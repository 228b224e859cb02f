// How much longer or shorter the ways of odometry are than they should be, learned while the robot
// drives: a wheel worn by half a millimetre, a carpet.
//
// Where the scans know the way, odometry hardly counts. Along bare walls it alone says how far the
// robot came, and a systematic error of two percent bends every corridor of the map by it.
#pragma once

#include <cstddef>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// A step as it should be: its position times a factor.
geometry::Pose2 scaled(const geometry::Pose2& T_by_odometry, double factor);

class OdometryScale {
 public:
  /// One step by odometry, as recorded, and by an accepted match of the same two stops. Counts only
  /// where the match knows the way: a step of 0.2 m or more, nearly straight, and along it a
  /// deviation of 0.04 m or less.
  void add(const geometry::Pose2& T_by_odometry, const UncertainPose& T_by_match);

  /// The ways of matches over those of odometry; 1 before there is a match.
  [[nodiscard]] double factor() const { return matched_ / driven_; }

  /// Steps after which an older one counts a third: the floor changes, and tyres lose air.
  static constexpr std::size_t kMemory = 500;

 private:
  // Begun as if one metre were known to 1 %: forty steps, so that the noise of a few bends no map.
  static constexpr double kPrior = 1.0 / (0.01 * 0.01);
  // Sums of ways in metres over variances. Of ways, not of squares: the noise of odometry would
  // make those too large.
  double matched_ = kPrior;
  double driven_ = kPrior;
};

}  // namespace topogeo::localization
