// Files that are read whole.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::exchange {

/// The content of a file of JSON or XML. Throws std::runtime_error naming the file and the cause
/// when it cannot be read, is no regular file or is over 64 MB.
std::string read_text(const std::filesystem::path& path);

/// The content of a map file; the same, over 2 GB.
std::string read_map_bytes(const std::filesystem::path& path);

}  // namespace topogeo::exchange
