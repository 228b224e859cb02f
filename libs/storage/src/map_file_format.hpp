// Start and end of a map file.
#pragma once

#include <cstddef>
#include <string_view>

namespace topogeo::storage {

inline constexpr std::string_view kMapFormat = "topogeo-map";
// Field 1 with its length: the start of every map file.
inline constexpr std::string_view kMapFileStart = "\x0a\x0btopogeo-map";
inline constexpr std::size_t kChecksumFieldSize = 9;  // one byte of tag, eight of value
inline constexpr char kChecksumTag = 0x79;            // field 15, 64 bits

}  // namespace topogeo::storage
