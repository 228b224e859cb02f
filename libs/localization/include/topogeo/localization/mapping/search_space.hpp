// How far around its prediction a match is searched, and which pairs are too uncertain to be worth
// it.
#pragma once

#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"

namespace topogeo::localization {

/// The task of this configuration for two maps of which a relative pose is predicted: the search
/// space, cut to the largest one, and all settings. The caller adds ids, hashes and seed.
MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// Whether a prediction is good enough for a match: its search space, not cut, is no larger than
/// the largest one. A search wider than that finds look-alikes.
bool searchable(const LocalizerConfig& config, const UncertainPose& T_reference_query);

/// PoseGraph::path_cost() beyond which no prediction is searchable().
double largest_searchable_cost(const LocalizerConfig& config);

}  // namespace topogeo::localization
