// Reads whole files.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::exchange {

/// The content of a file of JSON or XML. Throws std::runtime_error naming the file and the cause if
/// it cannot be read, is not a regular file or is over 64 MB.
std::string read_text(const std::filesystem::path& path);

/// The content of a map file; the limit is 2 GB.
std::string read_map_bytes(const std::filesystem::path& path);

}  // namespace topogeo::exchange
