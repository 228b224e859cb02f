// The worlds of the experiments: the scenes of share/figures and the replicas of
// share/thesis, and the configuration of the Thesis, compiled in so that the program needs no
// files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::reproduce {

struct WorldText {
  std::string_view name;  ///< file name without .world.yaml
  std::string_view text;
};

/// All worlds, by name.
const std::vector<WorldText>& world_texts();

/// Throws std::invalid_argument for an unknown name.
world::World world_named(std::string_view name);
bool has_world(std::string_view name);

/// share/thesis/thesis.config.yaml.
std::string_view thesis_preset_text();
pipeline::Config thesis_preset();

}  // namespace topogeo::reproduce
