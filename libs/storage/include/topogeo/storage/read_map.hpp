// Reads a map from any kind of map file.
#pragma once

#include <filesystem>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::storage {

/// Reads map.pb or map.sqlite; the content of the file decides, not its name. The file is not
/// changed, and a map store may be writing it. Throws std::runtime_error naming the path and the
/// cause, like read_map_file and MapDatabase::load.
MapDocument read_map(const std::filesystem::path& path);

}  // namespace topogeo::storage
