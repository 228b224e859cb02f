// Files that only their owner may read.
#pragma once

#include <filesystem>
#include <string_view>

namespace topogeo::support {

/// Writes a file of mode 0600, replacing any file with that name, completely or not at all. Throws
/// std::runtime_error naming the file and the cause.
void write_secret_file(const std::filesystem::path& path, std::string_view content);

}  // namespace topogeo::support
