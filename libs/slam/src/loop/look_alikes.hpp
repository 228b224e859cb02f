// Handling of matches from a widened search, which also finds places that only look alike.
#pragma once

#include <vector>

#include "loop/stop_match.hpp"
#include "odometry_steps.hpp"

namespace topogeo::localization {

/// Rejects all accepted matches of a widened search unless odometry allows at least one of them:
/// its squared Mahalanobis distance is within LookAlikeLimits::kAllowed2 (99 %).
void refuse_look_alikes(std::vector<StopMatch>& matches, const OdometrySteps& steps);

}  // namespace topogeo::localization
