// A map in the form of another program, by the name of the form: what `topogeo store export` and
// the page write (docs/exchange.md).
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/export_header.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/exchange/route_network.hpp"
#include "topogeo/pipeline/hybrid_map_config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct ExportSettings {
  pipeline::HybridMapConfig hybrid_map;  ///< of the grid
  std::optional<double> robot_radius_m;  ///< of graphs; none: what `hybrid_map` forbids around
                                         ///< obstacles
  NetworkSettings network;               ///< its robot_radius_m is not read
  ExportHeader header;                   ///< its robot_id is that of the map
  std::string title;                     ///< of the picture
};

struct ExportedMap {
  std::vector<OutputFile> files;  ///< one that names others comes last
  Notes notes;
};

struct ExportFormat {
  std::string_view name;
  /// What comes behind the name that is chosen for the files. That of a form of one file is only
  /// usual, others are fixed.
  std::vector<std::string_view> endings;
};

/// All forms, as docs/exchange.md has them.
std::span<const ExportFormat> export_formats();

/// `path`: the file, or what several begin with. Throws std::invalid_argument for a form that there
/// is not and where the map has not what it takes, std::runtime_error where a file cannot be made.
ExportedMap export_map(const storage::MapDocument& map, std::string_view format,
                       const std::filesystem::path& path, const ExportSettings& settings);

}  // namespace topogeo::exchange
