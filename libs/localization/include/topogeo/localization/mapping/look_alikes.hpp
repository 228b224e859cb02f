// Matches of a search wider than odometry asks for: such a search finds the place, and others that
// look like it.
#pragma once

#include <vector>

#include "topogeo/localization/mapping/odometry_steps.hpp"
#include "topogeo/localization/mapping/stop_match.hpp"

namespace topogeo::localization {

/// Refuses the accepted matches of a widened search, unless one at least is where odometry may have
/// brought the robot, within 99 %.
void refuse_look_alikes(std::vector<StopMatch>& matches, const OdometrySteps& steps);

}  // namespace topogeo::localization
