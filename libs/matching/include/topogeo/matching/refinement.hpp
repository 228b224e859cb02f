// Least squares around a first guess, from scan points to wall lines and from wall edges to wall
// edges. It turns the centimetres of the genetic search into millimetres and tracks the scans
// between two stops.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/fitness_forms.hpp"
#include "topogeo/matching/match_features.hpp"

namespace topogeo::localization {

/// Knowledge of the pose before the scans are compared.
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
  double inliers = 0.0;         ///< of those, share on a surface of the reference
  double violations =
      0.0;  ///< share of points in view where the other map saw free space; the worse direction
  double residual_rms_m = 0.0;  ///< of the inliers
};

/// PoseEvidence::information at a pose.
Eigen::Matrix3d information_at(const Reference& reference, const MatchFeatures& query,
                               const geometry::Pose2& T_reference_query);

/// The evidence at a fixed pose: the same maps give the same bits everywhere.
PoseEvidence evidence_at(const Reference& reference, const MatchFeatures& query,
                         const geometry::Pose2& T_reference_query);

/// Standard deviation of the normals of walls, fitted to scan points and implied by branches: 2 cm
/// over the 30 and 20 cm that a normal is fitted to.
inline constexpr double kScanNormalSigma_rad = 0.07;
inline constexpr double kBranchNormalSigma_rad = 0.1;

/// The information without what the errors of normals only seem to contain: each point of a wall
/// seems to know the position along the wall, by the square of the error of its normal, so a bare
/// corridor seems to show the position along itself. This is subtracted in the direction in which
/// the position is known least, at most all of it: the result may be singular.
Eigen::Matrix3d less_normal_errors(const Eigen::Matrix3d& information, double sigma_rad);

/// Final pose of the least squares.
struct Alignment {
  geometry::Pose2 T_reference_query;
  int iterations = 0;
  bool converged = false;
};

/// Gauss-Newton with a Cauchy weight, at most 15 iterations. With too few points for three unknowns
/// it returns the first guess, not converged.
Alignment align(const Reference& reference, const MatchFeatures& query,
                const geometry::Pose2& T_first_guess, const PosePrior& prior);

/// The prior for the last alignment of a match. The full prior leads to the place; there it would
/// decide which points belong together, and a door frame would be where odometry wants it.
PosePrior weak_prior(const PosePrior& prior);

/// The pose by the scans alone. align() ends where scans and prior balance, so a caller that also
/// uses the prior as a measurement would count it twice. `covariance` is that of the scans at
/// T_aligned. Takes one Newton step away from the prior, which is exact while the information of
/// the scans is constant; a step beyond 0.3 m or 0.05 rad is not taken. Along a direction in which
/// the scans leave the position uncertain by more than 0.5 m the pose does not move.
geometry::Pose2 without_prior(const geometry::Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                              const PosePrior& prior);

/// The pose where scans and the full prior balance, from the one where the scans balance with
/// weak_prior(): for callers without another use of the prior. `covariance` as above, not zero.
geometry::Pose2 with_prior(const geometry::Pose2& T_aligned, const Eigen::Matrix3d& covariance,
                           const PosePrior& prior);

/// A refined pose and the evidence for it.
struct Refinement : PoseEvidence {
  geometry::Pose2 T_reference_query;
  int iterations = 0;
  bool converged = false;
};

/// align(), then evidence_at() its result.
Refinement refine(const Reference& reference, const MatchFeatures& query,
                  const geometry::Pose2& T_first_guess, const PosePrior& prior);

/// Whether two poses are so close that refinement merges them: within 0.3 m and 0.15 rad.
bool same_place(const geometry::Pose2& a, const geometry::Pose2& b);

}  // namespace topogeo::localization
