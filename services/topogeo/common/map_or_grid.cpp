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

namespace topogeo::cli {

std::shared_ptr<const localization::StoredMap> load_map_or_grid(const std::filesystem::path& file,
                                                                const pipeline::Config& config) {
  std::optional<planning::OccupancyGrid> grid;
  std::string robot_id = "drawing";
  if (file.extension() == ".yaml") {
    exchange::GridImage image = exchange::read_grid_image(file);
    for (const std::string& note : image.notes) std::cerr << "topogeo: " << note << '\n';
    grid = exchange::occupancy_of(image);
  } else if (storage::MapDocument document = storage::read_map(file); document.local_maps.empty()) {
    grid = std::move(document.drawing.grid);
    robot_id = document.robot_id;
  }
  if (!grid) return pipeline::load_stored_map(file);
  exchange::check_grid_size(grid->frame());
  const storage::MapDocument made =
      exchange::map_of_grid(planning::FreeSpace(*std::move(grid), config.hybrid_map.inflation),
                            config.local_mapper, config.global_map, robot_id);
  std::cerr << fmt::format("topogeo: {} is a grid, {} stops are made of it\n", file.string(),
                           made.local_maps.size());
  return pipeline::stored_map(made);
}

}  // namespace topogeo::cli
