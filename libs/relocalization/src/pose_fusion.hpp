// Fusion of several measurements of one pose.
#pragma once

#include <vector>

#include "topogeo/matching/odometry_model.hpp"

namespace topogeo::localization {

/// The most likely pose of several independent measurements in one frame; at least one. Their
/// covariances must be positive definite.
UncertainPose fused(const std::vector<UncertainPose>& measurements);

/// Whether a measured pose is within a squared Mahalanobis distance of an independent prediction.
bool agree(const UncertainPose& predicted, const UncertainPose& measured,
           double most2 = geometry::kMahalanobis2Of99Percent);

/// Whether a quarter turn is within two deviations, as after metres that nothing mapped, by
/// odometry that few matches have confirmed. A room looks alike after a quarter turn, so one match
/// then proves no heading.
bool heading_is_lost(const UncertainPose& pose);

/// Selects those of the `chosen` poses that lead to the place of most of them, within half a metre
/// and 15 degrees; none if there is no place with more than half of them, or fewer than `fewest`.
std::vector<bool> of_one_place(const std::vector<UncertainPose>& T_map_robot,
                               const std::vector<bool>& chosen, int fewest);

}  // namespace topogeo::localization
