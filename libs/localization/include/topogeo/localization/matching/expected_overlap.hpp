// How much of one map another one should see, before a match is spent on them.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// Some 40 of the thinned points of a scan (MatchFeatures::coarse), robot frame: enough to foresee
/// overlap. Empty for none.
std::vector<SurfacePoint> outline_of(std::span<const SurfacePoint> coarse);

/// Share of the outline that the viewer should see at a pose (of the outline's robot in the frame
/// of the viewer) that is not known exactly, [0, 1]; 0 for an empty outline, and as soon as it is
/// sure to come out below `least`.
double expected_overlap(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                        const UncertainPose& T_viewer_outline, double least = 0.0);

/// Share of the outline that lies about where the viewer saw a surface: what two maps can be
/// matched by, as far as the prediction says. Never more than expected_overlap(), which counts what
/// the viewer saw past, too.
double expected_common(const RangeProfile& viewer, std::span<const SurfacePoint> outline,
                       const UncertainPose& T_viewer_outline);

}  // namespace topogeo::localization
