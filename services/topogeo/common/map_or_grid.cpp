#include "common/map_or_grid.hpp"

#include <iostream>
#include <optional>
#include <string>
#include <utility>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/grid_map.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/format.hpp"

#include "common/configuration.hpp"

namespace topogeo::cli {

planning::OccupancyGrid read_grid(const std::filesystem::path& file) {
  exchange::GridImage image = exchange::read_grid_image(file);
  print_notes(image.notes);
  return exchange::occupancy_of(image);
}

storage::MapDocument map_with_stops(planning::OccupancyGrid grid, const pipeline::Config& config,
                                    const std::string& robot_id) {
  exchange::check_grid_size(grid.frame());
  return exchange::map_of_grid(planning::FreeSpace(std::move(grid), config.hybrid_map.inflation),
                               config.local_mapper, config.global_map, robot_id);
}

std::shared_ptr<const localization::StoredMap> load_map_or_grid(const std::filesystem::path& file,
                                                                const pipeline::Config& config) {
  std::optional<planning::OccupancyGrid> grid;
  std::string robot_id = "drawing";
  if (file.extension() == ".yaml") {
    grid = read_grid(file);
  } else if (storage::MapDocument document = storage::read_map(file); document.local_maps.empty()) {
    grid = std::move(document.drawing.grid);
    robot_id = document.robot_id;
  }
  if (!grid) return pipeline::load_stored_map(file);
  const storage::MapDocument made = map_with_stops(*std::move(grid), config, robot_id);
  std::cerr << fmt::format("topogeo: {} is a grid, {} stops are made of it\n", file.string(),
                           made.local_maps.size());
  return pipeline::stored_map(made);
}

}  // namespace topogeo::cli
