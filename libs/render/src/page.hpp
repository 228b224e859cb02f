// One page of a given size, drawn with the same strokes as PNG or SVG.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <cairo.h>

#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"

namespace topogeo::render {

/// Throws std::invalid_argument for a width out of range.
void check(const PictureOptions& options);

/// The bytes of the file. The same strokes give the same SVG bytes. Throws std::runtime_error if
/// cairo cannot draw (no memory, more than 32,767 pixels a side in a PNG).
std::string draw_page(PictureFormat format, std::uint32_t width_px, std::uint32_t height_px,
                      const std::function<void(cairo_t*)>& draw);

}  // namespace topogeo::render
