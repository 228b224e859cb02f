// Files that are read whole.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::exchange {

/// Of JSON or XML. Throws std::runtime_error naming the file and the cause when it cannot be read,
/// is no regular file or is over 64 MB.
std::string read_text(const std::filesystem::path& path);

/// Of a map file; the same, over 2 GB.
std::string read_map_bytes(const std::filesystem::path& path);

}  // namespace topogeo::exchange
