// Command-line options for drawings on a map.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::map_store {

struct DrawingOptions {
  std::optional<std::filesystem::path> drawing;
  std::optional<std::filesystem::path> zones;
  std::optional<std::string> pose;  ///< T_map_drawing
  std::optional<std::filesystem::path> places;
};

/// Adds --drawing, --zones, --drawing-pose and --places; `options` must outlive the app.
void add_drawing_options(command_line::Command& app, DrawingOptions& options);

/// The drawing in the map frame; empty without any of the flags. Throws service::UsageError for
/// flags that do not go together or a malformed pose, service::BadInputError naming the file for
/// one that cannot be read.
storage::MapDrawing read_drawing(const DrawingOptions& options, double resolution_m);

}  // namespace topogeo::map_store
