// Grids as an image and a YAML file beside it, as map_server of ROS reads and writes them
// (docs/exchange.md, "Grid").
//
// planning/grid_file.hpp reads the drawings of this project and is strict. This reads what others
// write: all three modes, keys that it does not know, `negate` as a number or a word.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::exchange {

/// FLOOR.yaml and FLOOR.pgm, the image first, for a path FLOOR, FLOOR.yaml or FLOOR.pgm. Free 254,
/// unknown 205, occupied 0, thresholds 0.65 and 0.196: readers with either rule for a pixel on a
/// threshold get the same cells. A grid that is turned in the map frame is sampled anew without a
/// turn, since Nav2 ignores it.
std::vector<OutputFile> grid_files(const std::filesystem::path& path,
                                   const planning::OccupancyGrid& grid);

/// The same cells on axes parallel to those of the map, each as at its middle; the grid itself when
/// it is not turned. Throws std::invalid_argument when it grows too large (see check(GridFrame)).
planning::OccupancyGrid without_turn(const planning::OccupancyGrid& grid);

enum class ImageMode : std::uint8_t { kTrinary, kScale, kRaw };

/// An image as map_server publishes it.
struct GridImage {
  planning::GridFrame frame;
  std::vector<std::int8_t> values;  ///< 0 free to 100 occupied, -1 unknown; row by row from below
  ImageMode mode = ImageMode::kTrinary;
  Notes notes;
};

/// Reads by the rules of map_server since ROS 2 Jazzy. Throws std::runtime_error naming the file,
/// and the line or field with what was expected; images that are not PGM are refused.
GridImage read_grid_image(const std::filesystem::path& yaml_path);

/// Free up to 19, occupied from 65 on, as the thresholds that map_saver writes; else unknown.
planning::OccupancyGrid occupancy_of(const GridImage& image);

/// An image whose pixels are the values themselves (mode raw), beside a YAML file that begins with
/// `comment`; `values` are 0 to 100, row by row from below.
std::vector<OutputFile> raw_files(const std::filesystem::path& path,
                                  const planning::GridFrame& frame,
                                  const std::vector<std::uint8_t>& values,
                                  const std::string& comment);

}  // namespace topogeo::exchange
