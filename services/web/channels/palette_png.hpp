// Pictures of few colours as PNG.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace topogeo::web {

struct Color {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  std::uint8_t alpha = 255;
};

/// `pixels`: indices into at most 16 colours, row by row from the upper left one. Throws
/// std::runtime_error when encoding fails and std::invalid_argument for a wrong number of pixels.
std::string palette_png(std::uint32_t width, std::uint32_t height,
                        std::span<const std::uint8_t> pixels, std::span<const Color> colors);

}  // namespace topogeo::web
