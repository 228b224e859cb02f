// Files that are written completely or not at all, whatever happens during the writing.
#pragma once

#include <filesystem>
#include <string_view>

namespace topogeo::support {

/// Writes `content` beside `path`, forces it to disk and renames it to `path`, so that a reader or
/// a crash finds either the old file or the new one. Throws std::runtime_error naming `path` and
/// the cause; the old file is then unchanged and no other file is left.
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Creates the directory and its parents if needed, and checks that it is writable by writing and
/// removing a file. Throws std::runtime_error naming it and the cause.
void check_writable_directory(const std::filesystem::path& directory);

}  // namespace topogeo::support
