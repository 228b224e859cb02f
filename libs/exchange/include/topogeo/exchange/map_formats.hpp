// The formats in which maps are written and read, one row each (docs/exchange.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/exchange/grid_image.hpp"
#include "topogeo/exchange/map_graph.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct ExportSettings;  // map_export.hpp
struct ExportedMap;

struct ImportSettings {
  double resolution_m = 0.05;                 ///< cells of a grid made from walls
  Pixel205 pixel_205 = Pixel205::kAutomatic;  ///< of the images of grids
};

struct MapFormat {
  std::string_view name;
  /// Endings of the written files, appended to the chosen name. For a single file the ending is
  /// only usual, for several it is fixed.
  std::vector<std::string_view> endings{};

  std::string_view write_help{};  ///< content of the written files, for people
  /// Null for a format that is only read. See export_map().
  ExportedMap (*write)(const storage::MapDocument& map, const std::filesystem::path& path,
                       const ExportSettings& settings) = nullptr;

  std::string_view read_help{};  ///< accepted files, for people
  /// Null for a format that is only written. Throws std::runtime_error naming the file, the line or
  /// field and the expectation.
  MapGraph (*read)(const std::filesystem::path& file, const ImportSettings& settings) = nullptr;
};

/// The formats that can be written.
std::span<const MapFormat> export_formats();
/// The formats that can be read.
std::span<const MapFormat> import_formats();

struct FormatGuess {
  std::string format;  ///< name of a format that can be read
  std::string reason;  ///< for people: "it has features"
};

/// The format of a file by its content and its name. Throws std::runtime_error naming the file if
/// it cannot be read or the content does not show the format.
FormatGuess guess_import_format(const std::filesystem::path& file);

/// The row of a format. Throws std::invalid_argument for a name that `formats` lacks.
const MapFormat& format_named(std::span<const MapFormat> formats, std::string_view name);

}  // namespace topogeo::exchange
