// Search space of a match around its prediction, and the limit beyond which a pair is too uncertain
// to be matched.
#pragma once

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"

namespace topogeo::localization {

/// The task for two maps with a predicted relative pose: the search space, cut to the largest one,
/// and all settings. The caller adds ids, hashes and seed.
MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// Whether a prediction is good enough for a match: its search space, before cutting, is no larger
/// than the largest one. A wider search finds look-alikes.
bool searchable(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// PoseGraph::path_cost() beyond which no prediction is searchable().
double largest_searchable_cost(const LocalizerConfig& config);

}  // namespace topogeo::localization
