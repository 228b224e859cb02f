// Reads a map from whatever file holds one.
#pragma once

#include <filesystem>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

/// Reads map.pb or map.sqlite; the content of the file decides, not its name. The file stays as it
/// is, also while a map store writes it. Throws std::runtime_error naming the path and the cause,
/// like read_map_file and MapDatabase::load.
MapDocument read_map(const std::filesystem::path& path);

}  // namespace topogeo::storage
