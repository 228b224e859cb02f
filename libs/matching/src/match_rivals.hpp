// Searches another pose that the maps allow as well as the result.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"

#include "match_evidence.hpp"

namespace topogeo::localization {

/// The best pose of the search space at least 0.4 m away from `T_found` and with its heading, on
/// eight rays from it, the first along the direction that the scans determine worst: in a corridor
/// the next door frames lie there. The fitness leaves out odometry, because the search has used it
/// already; 0 if there is no such pose.
MatchSolution strongest_rival(const MatchContext& context, const geometry::Pose2& T_found);

}  // namespace topogeo::localization
