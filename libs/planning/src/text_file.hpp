// Reads whole files.
#pragma once

#include <filesystem>
#include <string>

namespace topogeo::planning {

/// Reads a regular file of the size that support/foreign_file.hpp allows for its kind. Throws
/// std::runtime_error naming the file if it is larger or cannot be read.
std::string read_yaml_file(const std::filesystem::path& path);
std::string read_image_file(const std::filesystem::path& path);

}  // namespace topogeo::planning
