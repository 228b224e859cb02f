// Files that are there whole or not at all, whatever happens while they are written.
#pragma once

#include <filesystem>
#include <string_view>

namespace topogeo::support {

/// Writes `content` beside `path`, forces it to disk and renames it to `path`, so that a reader or
/// a crash sees the old file or the new one. Throws std::runtime_error naming `path` and the cause;
/// the old file is then untouched and nothing is left behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Creates the directory and its parents where needed and proves by writing and removing a file
/// that it can be written. Throws std::runtime_error naming it and the cause.
void check_writable_directory(const std::filesystem::path& directory);

}  // namespace topogeo::support
