// Measures the error of odometry while the robot drives, so that odometry worse than configured
// gets a wider covariance instead of breaking the map.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Factors on the configured variances, from the squared differences between odometry and accepted
/// matches over the last steps. For weighing and searching they are never below 1, because there a
/// covariance that is too small costs more than one that is too large.
class OdometryMonitor {
 public:
  /// Squared Mahalanobis distance from odometry. Right doubtful matches are within two deviations,
  /// most look-alikes are not (docs/decisions/doubtful_steps.md).
  static constexpr double kNear2 = 4.0;

  /// One step by odometry, with its configured covariance, and by an accepted match, with its own
  /// covariance: both between the same two poses, covariances in the frame of the first.
  void add(const UncertainPose& odometry, const UncertainPose& match);

  /// The covariance widened to the errors of the last steps.
  [[nodiscard]] Eigen::Matrix3d widened(const Eigen::Matrix3d& configured) const;

  /// The covariance expected for a step without a match, by the errors of the last steps: smaller
  /// too if odometry is better than configured.
  [[nodiscard]] Eigen::Matrix3d expected(const Eigen::Matrix3d& configured) const;

  [[nodiscard]] double translation_factor() const { return translation_.factor(); }
  [[nodiscard]] double heading_factor() const { return heading_.factor(); }

 private:
  /// A mean over about kMemory steps; older ones fade.
  class Ratio {
   public:
    /// `squared`: the squared difference; then its variances as odometry and match state them.
    void add(double squared, double odometry_variance, double match_variance);
    /// At least 1.
    [[nodiscard]] double factor() const;
    /// With a margin, because errors of odometry add up from step to step.
    [[nodiscard]] double expected_factor() const;

   private:
    static constexpr double kMemory = 20.0;
    double weighted_ = kMemory;  // starts as if kMemory steps had been as configured
    double weight_ = kMemory;
  };
  Ratio translation_;
  Ratio heading_;
};

}  // namespace topogeo::localization
