// Images of maps: PGM, PNG and BMP.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::exchange {

struct RasterImage {
  std::int32_t width = 0;
  std::int32_t height = 0;
  int white = 255;                        ///< value of white
  std::vector<std::uint16_t> grey;        ///< row by row from the top; sum of colours
  std::vector<std::uint8_t> see_through;  ///< 1: not opaque; empty: all are opaque
};

/// Whether a file that begins so is an image of one of these formats, by its sign alone.
bool is_raster_image(std::string_view start);

/// Detects the format from the content. Throws std::runtime_error naming `source` and the fault.
RasterImage parse_raster_image(std::string_view bytes, const std::string& source);

}  // namespace topogeo::exchange
