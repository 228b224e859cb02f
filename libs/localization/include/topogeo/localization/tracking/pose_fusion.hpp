// Fusion of several measurements of one pose.
#pragma once

#include <vector>

#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// The most likely pose of several independent measurements in one frame; at least one. Their
/// covariances must be positive definite.
UncertainPose fused(const std::vector<UncertainPose>& measurements);

}  // namespace topogeo::localization
