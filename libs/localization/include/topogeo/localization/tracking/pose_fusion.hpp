// Fusion of several measurements of one pose.
#pragma once

#include <vector>

#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// The most likely pose of several independent measurements in one frame; at least one. Their
/// covariances must be positive definite.
UncertainPose fused(const std::vector<UncertainPose>& measurements);

/// Whether a quarter turn is within two deviations. A room looks alike after a quarter turn, so one
/// match proves no heading then. Such is a step of metres that nothing mapped, by odometry that few
/// matches have confirmed.
bool heading_is_lost(const UncertainPose& pose);

/// Selects the poses of the place that most of them lead to, within half a metre and 15 degrees;
/// none if there is no place with more than half of them.
std::vector<bool> of_one_place(const std::vector<geometry::Pose2>& T_map_robot);

}  // namespace topogeo::localization
