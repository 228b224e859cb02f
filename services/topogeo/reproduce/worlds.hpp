// The worlds of the experiments: the scenes of share/figures and the replicas of
// share/thesis, compiled in so that the program needs no files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

}  // namespace topogeo::reproduce
