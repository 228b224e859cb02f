// Creates the mapping algorithm that a configuration names.
#pragma once

#include <memory>

#include "topogeo/matching/match.hpp"
#include "topogeo/slam/graph_optimization.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/slam.hpp"

namespace topogeo::localization {

/// PoseGraphSlam or the added mode, by `config.mode`. The pool and the optimizer (see
/// PoseGraphSlam) must outlive it. Throws std::invalid_argument if the program does not have the
/// mode.
std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer = nullptr);

}  // namespace topogeo::localization
