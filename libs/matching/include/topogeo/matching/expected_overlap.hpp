// Predicts how much of one map another one sees, before a match is spent on them.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/matching/match_features.hpp"
#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Some 40 of the thinned points of a scan (MatchFeatures::coarse), robot frame: enough to predict
/// overlap. Empty without points.
std::vector<SurfacePoint> outline_of(std::span<const SurfacePoint> coarse);

/// Predicted share of the outline that the viewer sees at an uncertain pose (of the outline's robot
/// in the frame of the viewer), [0, 1]; 0 for an empty outline, and as soon as it is certain to be
/// below `least`.
double expected_overlap(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                        const UncertainPose& T_viewer_outline, double least = 0.0);

/// Predicted share of the outline that lies near a surface seen by the viewer: the part that two
/// maps can be matched by. Never more than expected_overlap(), which also counts points that the
/// viewer saw past.
double expected_common(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                       const UncertainPose& T_viewer_outline);

}  // namespace topogeo::localization
