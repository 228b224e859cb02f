// Creates the mapping algorithm that a configuration names.
#pragma once

#include <memory>

#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/matching/match.hpp"

namespace topogeo::localization {

/// PoseGraphSlam or ThesisSlam, by `config.mode`. The pool and the optimizer (see
/// PoseGraphSlam) must outlive it.
std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer = nullptr);

}  // namespace topogeo::localization
