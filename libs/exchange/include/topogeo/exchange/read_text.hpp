// Files that are read whole.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::exchange {

/// Throws std::runtime_error naming the file and the cause when it cannot be read or is over 2 GB.
std::string read_text(const std::filesystem::path& path);

}  // namespace topogeo::exchange
