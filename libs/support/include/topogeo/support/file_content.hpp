// A whole file in memory.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::support {

/// Throws std::runtime_error naming the path and the cause.
std::string file_content(const std::filesystem::path& path);

}  // namespace topogeo::support
