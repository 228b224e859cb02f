// The map that a command localizes in.
#pragma once

#include <filesystem>
#include <memory>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/pipeline/config.hpp"

namespace topogeo::cli {

/// Reads a map file or database. A grid (YAML of map_server), and a map that has nothing but one,
/// gets stops by simulated views, and stderr says so. Throws std::runtime_error naming the file.
std::shared_ptr<const localization::StoredMap> load_map_or_grid(const std::filesystem::path& file,
                                                                const pipeline::Config& config);

}  // namespace topogeo::cli
