// A whole file in memory.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::support {

/// The content of a regular file of up to 2 GB. Throws std::runtime_error naming the path and the
/// cause.
std::string file_content(const std::filesystem::path& path);

}  // namespace topogeo::support
