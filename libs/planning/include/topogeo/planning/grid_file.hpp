// Occupancy grids as files in the format of map_server of ROS: an image in PGM (P2 or P5) and a
// YAML file beside it.
//
//   image: floor.pgm            # beside the YAML file, or an absolute path
//   resolution: 0.1             # m per pixel
//   origin: [-1.0, -2.0, 0.0]   # x, y (m) and yaw (rad) of the lower left corner in the map frame
//   negate: 0                   # 1: white is occupied
//   occupied_thresh: 0.65       # a pixel darker than this is occupied, [0, 1]
//   free_thresh: 0.196          # a pixel less dark than this is free, [0, occupied_thresh]
//   mode: trinary               # optional; no other mode is supported
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Reads the YAML file and its image. Throws std::runtime_error naming the file, the line or field
/// and the expectation: an unreadable file, an unknown, missing or repeated key, a value out of
/// range, an image that is not PGM, has a depth other than 1 to 255, is too large or truncated.
OccupancyGrid read_grid(const std::filesystem::path& yaml_path);

enum class PgmForm : std::uint8_t { kBinary, kText };  ///< P5, P2

/// Writes `yaml_path` and an image of the same name with the ending .pgm beside it, each whole or
/// not at all: free 254, unknown 205, occupied 0, with thresholds that reproduce them. Throws
/// std::runtime_error naming the file and the cause.
void write_grid(const std::filesystem::path& yaml_path, const OccupancyGrid& grid,
                PgmForm form = PgmForm::kBinary);

}  // namespace topogeo::planning
