// Refinement and evidence of a match by nodes and branches alone (own; docs/algorithms.md,
// "Refinement and gate"): the counterpart of refinement.hpp without scan points.
//
// A branch is the middle between two objects, so it is known across to a third of the error of a
// reading, and with it the heading; along it only where the clearance changes, and at nodes.
#pragma once

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/refinement.hpp"

namespace topogeo::localization {

/// PoseEvidence::information at a pose.
Eigen::Matrix3d branch_information_at(const Reference& reference, const MatchFeatures& query,
                                      const geometry::Pose2& T_reference_query);

/// The evidence at a pose, as evidence_at() with samples of branches in place of points. In view is
/// what lies within the clearance of a branch of the reference, or near one; an inlier lies on a
/// branch of the same direction and clearance. The clearance of two places differs by their
/// distance at most: where it differs by more, one map saw free space and the other an object.
PoseEvidence branch_evidence_at(const Reference& reference, const MatchFeatures& query,
                                const geometry::Pose2& T_reference_query);

/// As align(): samples against the line of the branch beneath them and against its clearance,
/// nodes against nodes of their kind.
Alignment align_branches(const Reference& reference, const MatchFeatures& query,
                         const geometry::Pose2& T_first_guess, const PosePrior& prior);

}  // namespace topogeo::localization
