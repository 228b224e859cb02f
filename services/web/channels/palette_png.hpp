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

/// `pixels`: indices into at most 16 colours, from the upper left one row by row. Throws
/// std::runtime_error when it cannot be made and std::invalid_argument for another count of pixels.
std::string palette_png(std::uint32_t width, std::uint32_t height,
                        std::span<const std::uint8_t> pixels, std::span<const Color> colors);

}  // namespace topogeo::web
