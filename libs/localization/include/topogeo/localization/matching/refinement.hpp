// Least squares around a first guess, scan points to the lines of walls and edges of walls to
// edges: what turns the centimetres of the genetic search into millimetres, and what tracks the
// scans between two stops.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/fitness.hpp"
#include "topogeo/localization/matching/match_features.hpp"

namespace topogeo::localization {

/// What is known of the pose before the scans are compared.
struct PosePrior {
  geometry::Pose2 T_reference_query;
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  ///< of (x, y, theta) in the reference frame; zero: no prior
};

/// The evidence of the scans for one pose.
struct PoseEvidence {
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  ///< Hessian of the data term, 1/m^2, 1/m, 1/rad^2; zero with too
                                ///< few points for three unknowns
  double overlap = 0.0;         ///< share of the query's points in the view of the reference
  double inliers = 0.0;         ///< of those, share that lie on a surface of the reference
  double violations =
      0.0;  ///< share of points in view where the other map saw free space; the worse direction
  double residual_rms_m = 0.0;  ///< of the inliers
};

/// PoseEvidence::information at a pose.
Eigen::Matrix3d information_at(const Reference& reference, const MatchFeatures& query,
                               const geometry::Pose2& T_reference_query);

/// The evidence at a pose, which stays as it is: anyone with the two maps gets the same bits.
PoseEvidence evidence_at(const Reference& reference, const MatchFeatures& query,
                         const geometry::Pose2& T_reference_query);

/// Where the least squares ended.
struct Alignment {
  geometry::Pose2 T_reference_query;
  int iterations = 0;
  bool converged = false;
};

/// Gauss-Newton with a Cauchy weight, at most 15 iterations. With too few points for three
/// unknowns the pose comes back as it was, not converged.
Alignment align(const Reference& reference, const MatchFeatures& query,
                const geometry::Pose2& T_first_guess, const PosePrior& prior);

/// The prior that a match ends with. The whole one leads to the place; there it would choose which
/// points lie together, and a door frame would be where odometry wants it.
PosePrior weak_prior(const PosePrior& prior);

/// The pose by the scans alone: align() ends where scans and prior balance, so whoever uses the
/// prior as a measurement of its own would count it twice. `covariance` is that of the scans at
/// T_aligned. One Newton step away from the prior, which is exact as long as the scans' information
/// stays the same in between; a step beyond 0.3 m or 0.05 rad is not taken. Along a direction in
/// which the scans leave the position uncertain by more than 0.5 m the pose stays where it is.
geometry::Pose2 without_prior(const geometry::Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                              const PosePrior& prior);

/// The pose where scans and the whole prior balance, from the one where the scans balance with
/// weak_prior(): for those who have no other use of the prior. `covariance` as above, not zero.
geometry::Pose2 with_prior(const geometry::Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                           const PosePrior& prior);

/// A refined pose and the evidence for it.
struct Refinement : PoseEvidence {
  geometry::Pose2 T_reference_query;
  int iterations = 0;
  bool converged = false;
};

/// align(), and evidence_at() where it ended.
Refinement refine(const Reference& reference, const MatchFeatures& query,
                  const geometry::Pose2& T_first_guess, const PosePrior& prior);

}  // namespace topogeo::localization
