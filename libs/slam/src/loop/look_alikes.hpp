// Handling of matches from a widened search: it finds the place, and others that look like it.
#pragma once

#include <vector>

#include "loop/stop_match.hpp"
#include "odometry_steps.hpp"

namespace topogeo::localization {

/// Rejects the accepted matches of a widened search unless odometry allows at least one of them (99
/// %).
void refuse_look_alikes(std::vector<StopMatch>& matches, const OdometrySteps& steps);

}  // namespace topogeo::localization
