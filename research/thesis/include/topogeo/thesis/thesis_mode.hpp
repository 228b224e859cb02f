// The thesis's algorithm as a value of `localizer.mode`.
#pragma once

#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/thesis/thesis_config.hpp"

namespace topogeo::localization {

/// Makes SlamAlgorithm::kThesis available, and its settings part of all configurations that are
/// made later (add_mode()).
void add_thesis_mode();

/// `config` with the thesis's settings in it; their defaults if it was made before
/// add_thesis_mode().
ThesisSlamConfig thesis_config(const LocalizerConfig& config);

}  // namespace topogeo::localization
