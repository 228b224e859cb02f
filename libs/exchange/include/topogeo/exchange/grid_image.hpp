// Grids as an image and a YAML file, in the format of map_server of ROS (docs/exchange.md, "Grid").
//
// planning/grid_file.hpp reads the drawings of this project strictly. This reader also accepts
// foreign files: all three modes, unknown keys, `negate` as a number or a word.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/exchange/output_file.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::exchange {

/// FLOOR.yaml and FLOOR.pgm, the image first, for a path FLOOR, FLOOR.yaml or FLOOR.pgm. Free 254,
/// unknown 205, occupied 0, thresholds 0.65 and 0.196: readers get the same cells, however they
/// treat a pixel on a threshold. A grid that is rotated in the map frame is resampled without
/// rotation, because Nav2 ignores it.
std::vector<OutputFile> grid_files(const std::filesystem::path& path,
                                   const planning::OccupancyGrid& grid);

/// The grid resampled at the cells' middles on the axes of the map; unchanged if it is not rotated.
/// Throws std::invalid_argument if it grows too large (see check(GridFrame)).
planning::OccupancyGrid without_turn(const planning::OccupancyGrid& grid);

enum class ImageMode : std::uint8_t { kTrinary, kScale, kRaw };

/// An image in the values that map_server publishes.
struct GridImage {
  planning::GridFrame frame;
  std::vector<std::int8_t> values;  ///< 0 free to 100 occupied, -1 unknown; row by row from below
  ImageMode mode = ImageMode::kTrinary;
  Notes notes;
};

/// How the pixel value that map_saver writes for unknown cells is read.
enum class Pixel205 : std::uint8_t {
  kAutomatic,  ///< unknown if the image has only the values of map_saver: 0, 205, 254, 255
  kUnknown,
  kThreshold,  ///< as the thresholds of the YAML file say
};

/// Reads by the rules of map_server since ROS 2 Jazzy, but for `pixel_205` in mode trinary. Throws
/// std::runtime_error naming the file, the line or field and the expectation; accepts images in
/// PGM, PNG and BMP.
GridImage read_grid_image(const std::filesystem::path& yaml_path,
                          Pixel205 pixel_205 = Pixel205::kAutomatic);

/// Free up to 19, occupied from 65 on, like the thresholds of map_saver; else unknown.
planning::OccupancyGrid occupancy_of(const GridImage& image);

/// An image whose pixels are the values themselves (mode raw), and a YAML file that begins with
/// `comment`; `values` are 0 to 100, row by row from below.
std::vector<OutputFile> raw_files(const std::filesystem::path& path,
                                  const planning::GridFrame& frame,
                                  const std::vector<std::uint8_t>& values,
                                  const std::string& comment);

}  // namespace topogeo::exchange
