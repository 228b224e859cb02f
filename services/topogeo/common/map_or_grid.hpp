// Maps that commands make from grids, by simulated views.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/planning/occupancy_grid.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::cli {

/// A grid by the YAML file of map_server; its notes go to stderr. Throws std::runtime_error
/// naming the file.
planning::OccupancyGrid read_grid(const std::filesystem::path& file);

/// A map with stops all over the grid. Throws std::runtime_error for a grid that is too large.
storage::MapDocument map_with_stops(planning::OccupancyGrid grid, const pipeline::Config& config,
                                    const std::string& robot_id);

/// The map of a file or database to localize in. A grid (YAML of map_server), or a map that
/// consists of a grid only, gets stops, which is reported on stderr. Throws std::runtime_error
/// naming the file.
std::shared_ptr<const localization::StoredMap> load_map_or_grid(const std::filesystem::path& file,
                                                                const pipeline::Config& config);

}  // namespace topogeo::cli
