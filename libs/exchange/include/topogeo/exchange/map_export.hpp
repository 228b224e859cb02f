// Exports a map to the format of another program, selected by name, for `topogeo store export` and
// the page (docs/exchange.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/export_header.hpp"
#include "topogeo/exchange/map_formats.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/pipeline/hybrid_map_config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct ExportSettings {
  pipeline::HybridMapConfig hybrid_map;  ///< of the grid
  std::optional<double> robot_radius_m;  ///< of graphs; none: the distance that `hybrid_map` keeps
                                         ///< from obstacles
  NetworkSettings network;               ///< without its robot_radius_m
  ExportHeader header;                   ///< with the robot_id of the map
  std::string title;                     ///< of the picture
  bool odometry = true;                  ///< in the picture: the drive by odometry alone
  bool loops = true;                     ///< in the picture: the loop closures
};

struct ExportedMap {
  std::vector<OutputFile> files;  ///< a file that names others comes last
  Notes notes;
};

/// `path`: the file, or the common start of several. Throws std::invalid_argument for an unknown
/// format or a map that lacks what it needs, std::runtime_error if a file cannot be made.
ExportedMap export_map(const storage::MapDocument& map, std::string_view format,
                       const std::filesystem::path& path, const ExportSettings& settings);

}  // namespace topogeo::exchange
