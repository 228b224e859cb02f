// Searches another pose that the maps allow as well as the one that was found.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/match.hpp"

#include "match_evidence.hpp"

namespace topogeo::localization {

/// The pose of the search space that fits best of those at least 0.4 m away from `T_found` and of
/// its heading, on eight rays from it, the first along the direction that the scans fix worst: in a
/// corridor the next door frames lie there. The odometry does not count, because the search has
/// used it already. The fitness is without it, too; 0 if there is no such
/// pose.
MatchSolution strongest_rival(const MatchContext& context, const geometry::Pose2& T_found);

}  // namespace topogeo::localization
