// Several measurements of one pose made one.
#pragma once

#include <vector>

#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// The most likely pose of several measurements of one pose in one frame, whose errors are
/// independent; at least one. Their covariances must be positive definite.
UncertainPose fused(const std::vector<UncertainPose>& measurements);

}  // namespace topogeo::localization
