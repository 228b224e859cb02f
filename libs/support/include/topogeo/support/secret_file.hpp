// Files that their owner alone may read.
#pragma once

#include <filesystem>
#include <string_view>

namespace topogeo::support {

/// Writes a file of mode 0600 in place of what has that name, whole or not at all. Throws
/// std::runtime_error naming the file and the cause.
void write_secret_file(const std::filesystem::path& path, std::string_view content);

}  // namespace topogeo::support
