// The formats of picture files.
#pragma once

#include <cstdint>
#include <filesystem>

namespace topogeo::render {

enum class PictureFormat : std::uint8_t { kPng, kSvg };

/// Selects the format by the ending of the name, .png or .svg in any case. Throws
/// std::invalid_argument naming the file for any other.
PictureFormat picture_format(const std::filesystem::path& path);

}  // namespace topogeo::render
