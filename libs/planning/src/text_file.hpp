// Text files read whole.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::planning {

/// Throws std::runtime_error naming the file when it cannot be read or is over 1 GB.
std::string read_text_file(const std::filesystem::path& path);

}  // namespace topogeo::planning
